#include "tools/tdpt/pipeline.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/defaults.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

// Portals drawn by an artist, or imported with the scene, lie beside it; they name no scene.
std::string drawn_portals(const std::string& scene) {
  const std::string path = scene.substr(0, scene.find_last_of('.')) + ".portal.glb";
  std::error_code failed;
  if (path == scene || !fs::is_regular_file(path, failed)) return "";
  const std::string bytes = read_file(path);
  const bool found = bytes.find("\"generator\":\"tdpt ") != bytes.npos &&
                     bytes.find("\"scene_hash\":\"\"") == bytes.npos;
  return found ? "" : path;
}

}  // namespace

std::string hash_at(const std::string& path) {
  std::error_code failed;
  try {
    return fs::is_regular_file(path, failed) ? content_hash_of_file(path) : "";
  } catch (const InputError&) {
    return "";
  }
}

SceneState state_of(const Arguments& a) {
  SceneState state;
  std::error_code failed;
  if (fs::exists(a.scene, failed) && !fs::is_regular_file(a.scene, failed))  // read more than once
    throw InputError(a.scene, "", "is no regular file, expected a scene (.glb, .gltf)");
  std::string all = content_hash_of_file(a.scene);
  state.files.push_back(a.scene);
  const auto add = [&](const std::string& path) {
    const std::string hash = hash_at(path);
    if (!hash.empty()) state.files.push_back(path);
    return hash;
  };
  const SceneFiles files = files_of_scene(a.scene);
  state.has_sky = files.has_environment;
  for (const std::string& name : files.beside) {
    const std::string path = (fs::path(a.scene).parent_path() / name).string();
    all += "\n" + add(path);
  }
  state.hash = content_hash(all);
  state.sky = add(a.sky.environment);
  for (const std::string& path : a.portals) state.portals.push_back(add(path));
  if (a.portals.empty()) state.drawn = drawn_portals(a.scene);
  if (!state.drawn.empty()) state.portals.push_back(add(state.drawn));
  return state;
}

namespace {

Words joined(const std::vector<Words>& parts) {
  Words all;
  for (const Words& part : parts) append(all, part);
  return all;
}

std::string file_name(const std::string& path) {
  return fs::path(path).filename().string();
}

// Frames for which portals are found together: those between which nothing but cameras moves. Reads
// the scene.
std::vector<FrameRange> parts_of_shot(const Arguments& a) {
  SceneFile file(a.scene, a.pose.animations);
  const FrameRange range = frame_range(a.shot);
  std::vector<FrameRange> parts;
  std::string before;
  for (int64_t k = range.first; k <= range.last; ++k) {
    std::string pose = file.glance_at(static_cast<double>(k) / a.shot.fps).pose_hash;
    if (k > range.first && pose == before)
      parts.back().last = k;
    else
      parts.push_back({k, k});
    before = std::move(pose);
  }
  return parts;
}

// `frames`: of a shot; null: one picture. `moves`: the scene does between them, so there are many
// searches.
std::vector<Step> stages_of(const Arguments& a, const Request& r, const FrameRange* frames,
                            bool moves, const std::string& folder) {
  // When portals are sought, for ffgraph and for what needs only the scene, and how well.
  Words poses = r.pose, time = r.pose, sampling = r.sampling, running = r.running;
  if (frames) {
    append(poses, {"--frames", words_of(*frames), "--fps", fmt::format("{}", a.shot.fps)});
    append(time, {"--at", fmt::format("{}", static_cast<double>(frames->first) / a.shot.fps)});
    const bool has_quality =
        std::find(sampling.begin(), sampling.end(), "--quality") != sampling.end();
    if (moves && !has_quality) append(sampling, {"--quality", "draft"});
    if (moves) running.emplace_back("--quiet");
  }
  std::vector<Step> stages;
  const auto file = [&](const char* end) { return folder + "/scene." + end; };
  const auto stage = [&](const char* title, const char* tool, const Words& options,
                         const Words& inputs, const char* end) {
    stages.push_back(
        {title,
         joined({{program_folder() + "/" + tool}, options, r.stored, r.stage_flags[stages.size()]}),
         inputs, running, file(end)});
  };
  stage("tracing where light goes", "ffgraph", joined({r.cameras, poses, r.sky, sampling}),
        {r.scene}, "max");
  stage("finding bottlenecks", "mincut", {}, {file("max")}, "cut");
  stage("following the light through them", "lightgrid", joined({time, r.sky, r.device, sampling}),
        {r.scene, file("cut")}, "vdb");
  stage("fitting portals", "portalfit", {}, {file("vdb")}, "portal.glb");
  return stages;
}

// The scene and the sky by name and content: their names are part of the provenance.
Fingerprint files_of(const Arguments& a, const Request& r, const SceneState& state) {
  return {{"scene", file_name(r.scene) + " " + state.hash},
          {"environment", file_name(a.sky.environment) + " " + state.sky}};
}

// Its key: everything that the stages get, and their programs.
Search search_of(const Arguments& a, const Request& r, const SceneState& state, const Cache& cache,
                 const FrameRange* frames = nullptr, bool moves = false) {
  Fingerprint facts = files_of(a, r, state);
  for (const Step& stage : stages_of(a, r, frames, moves, "")) {
    std::string words;
    for (const std::string& word : stage.options) words += word + hash_at(word) + "\n";
    facts.emplace_back(stage.title, words);
  }
  const std::string entry = "portals-" + hash_of(facts);
  return {entry, stages_of(a, r, frames, moves, cache.path_of(entry)),
          frames ? *frames : FrameRange{}};
}

std::vector<Search> searches_of(const Arguments& a, const Request& r, const SceneState& state,
                                const Cache& cache) {
  if (!a.shot.is_given()) return {search_of(a, r, state, cache)};
  const std::vector<FrameRange> parts = parts_of_shot(a);
  std::vector<Search> searches;
  for (const FrameRange& part : parts)
    searches.push_back(search_of(a, r, state, cache, &part, parts.size() > 1 && part.count() == 1));
  return searches;
}

// What the picture is made of, or what these frames of a shot are. `given`: paths of portals that
// no stage finds.
Fingerprint facts_of(const Arguments& a, const Request& r, const SceneState& state,
                     const std::vector<Search>& searches, const Words& given,
                     const FrameRange& frames) {
  Fingerprint facts = files_of(a, r, state);
  std::string portals;
  for (const Search& search : searches)
    if (search.frames.first <= frames.last && frames.first <= search.frames.last)
      portals += search.entry + "\n";
  for (const std::string& hash : state.portals) portals += hash + "\n";
  for (const std::string& path : given) {
    portals += file_name(path) + "\n";
    if (has_frame_number(path))
      for (int64_t k = frames.first; k <= frames.last; ++k)
        portals += content_hash_of_file(name_of_frame("--portal", path, k)) + "\n";
  }
  facts.emplace_back("portals", portals);
  return facts;
}

// The scene, and portals as options of the renderer.
Words given_to(const Request& r, const Words& portals) {
  Words words{r.scene};
  for (const std::string& path : portals)
    append(words, {"--portal", path.starts_with('-') ? "./" + path : path});
  return words;
}

// The last stage writes what is asked for.
Pipeline pipeline_of_portals(const Arguments& a, const Request& r, const SceneState& state,
                             const Cache& cache) {
  Pipeline p;
  p.searches = {search_of(a, r, state, cache)};
  p.key = p.searches[0].entry;
  p.render = p.searches[0].stages.back();
  p.render.output = r.picture;
  p.searches[0].stages.pop_back();
  p.check = joined({{program_folder() + "/tdpt-render"},
                    r.camera,
                    r.pose,
                    r.sky,
                    r.device,
                    r.stored,
                    r.running,
                    {r.scene, "-o", "portals.exr", "--check"}});
  return p;
}

}  // namespace

Pipeline pipeline_of(const Arguments& a, const cli::Common& common, const Request& r,
                     const SceneState& state, const Cache& cache) {
  if (asks_for_portals(r.picture)) return pipeline_of_portals(a, r, state, cache);
  Pipeline p;
  const std::string renderer = program_folder() + "/tdpt-render";
  Words portals = a.portals;
  if (!state.drawn.empty()) portals.push_back(state.drawn);
  const Words given = portals;
  if (portals.empty() && uses_portals(a, state.has_sky))
    p.searches = searches_of(a, r, state, cache);
  const auto key_of = [&](const cli::Common& asked, const FrameRange& frames, const Words& tools,
                          cli::Effect up_to) {
    Fingerprint facts = facts_of(a, r, state, p.searches, given, frames);
    for (const std::string& tool : tools) facts.emplace_back(tool, content_hash_of_file(tool));
    return hash_of(asked.fingerprint(facts, up_to));
  };
  const FrameRange all = a.shot.is_given() ? frame_range(a.shot) : FrameRange{};
  p.key = key_of(common, all, {renderer}, cli::Effect::stored);
  const std::string shared = "film-" + key_of(common, all, {renderer}, cli::Effect::picture);
  p.shared_film = cache.path_of(shared) + "/film.exr";
  // A number of samples is added to those that are there; another end of a rendering is its own.
  const bool counts = !a.shot.is_given() && (a.spp > 0 || a.seconds > 0);
  p.entry = counts ? shared : "picture-" + p.key;
  if (p.searches.size() == 1) portals.push_back(p.searches[0].found());
  if (p.searches.size() > 1)
    portals.push_back(p.portals_by_frame = cache.path_of(p.entry) + "/frame.######.portal.glb");
  // Of the frames of a shot the renderer knows itself what is there and whole.
  p.repeatable = a.add_samples == 0 && !a.shot.is_given();
  Words film;
  if (a.checkpoint.empty() && a.resume.empty() && !a.shot.is_given()) {
    p.film = cache.path_of(p.entry) + "/film.exr";
    film = {"--checkpoint", p.film, "--resume", p.film};
  }
  const Words options = joined({{renderer}, r.render});
  p.check =
      joined({Step{"", options, given_to(r, given), film, ""}.command(r.picture), {"--check"}});
  p.render = {"rendering", options, given_to(r, portals), film, r.picture};
  if (!filters_frames(a)) return p;
  const std::string filter = program_folder() + "/exrdenoise";
  p.noisy = cache.path_of(p.entry) + "/noisy";
  p.render.output = p.noisy + "/frame.######.exr";
  for (int64_t k = all.first; k <= all.last; ++k) {
    const FrameRange beside_it{std::max(all.first, k - 1), std::min(all.last, k + 1)};
    cli::Common asked = common;
    asked.give("--frames", {words_of(beside_it), std::to_string(k)});
    const auto noisy = [&](int64_t frame) { return name_of_frame("", p.render.output, frame); };
    Words words = joined({{filter}, r.filter, r.stored, r.running, {noisy(k)}});
    if (k > all.first) append(words, {"--previous", noisy(k - 1)});
    if (k < all.last) append(words, {"--next", noisy(k + 1)});
    p.filtered.push_back({k, name_of_frame("-o", r.picture, k),
                          key_of(asked, beside_it, {renderer, filter}, cli::Effect::stored),
                          words});
  }
  return p;
}

Words Step::command(const std::string& to) const {
  return joined({options, unshaped, inputs, {"-o", to}});
}

Words command_for(const Step& render, const FrameRange& frames) {
  Words words = render.command(render.output);
  *(std::find(words.begin(), words.end(), "--frames") + 1) = words_of(frames);
  return words;
}

std::vector<FrameRange> with_those_beside(const std::vector<FilteredFrame>& frames,
                                          const FrameRange& all) {
  std::vector<FrameRange> runs;
  for (const FilteredFrame& frame : frames) {
    const FrameRange near{std::max(all.first, frame.number - 1),
                          std::min(all.last, frame.number + 1)};
    if (!runs.empty() && near.first <= runs.back().last + 1)
      runs.back().last = near.last;
    else
      runs.push_back(near);
  }
  return runs;
}

std::string shell_text(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_quoted(word);
  return text;
}

}  // namespace tdpt
