#include "tools/tdpt/pipeline.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "libcommon/base/hash.h"
#include "libcommon/base/shell_quoted.h"
#include "tools/tdpt/parts.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

// The hash of a list of strings, encoded so that no other list gives the same bytes.
class Key {
 public:
  void add(const std::string& part) { text_ += std::to_string(part.size()) + ':' + part; }
  void add(const Words& words) {
    add(std::to_string(words.size()));
    for (const std::string& word : words) add(word);
  }
  std::string hash() const { return content_hash(text_); }

 private:
  std::string text_;
};

Words joined(const std::vector<Words>& parts) {
  Words all;
  for (const Words& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::string file_name(const std::string& path) {
  return fs::path(path).filename().string();
}

// The same words, with the hash of the sky's file added, and of its path only the name, which is
// part of the provenance.
Words by_content(Words sky, const std::string& hash) {
  for (size_t i = 0; !hash.empty() && i < sky.size(); ++i)
    if (sky[i].starts_with("--environment=") || (i > 0 && sky[i - 1] == "--environment"))
      sky[i] = file_name(sky[i]) + hash;
  return sky;
}

// The words of one search: when portals are sought, for ffgraph and for what needs only the scene,
// and how well.
struct Sought {
  Words poses, time, sampling;
};

Sought sought(const Arguments& a, const Request& r, const Part* part) {
  Sought s{r.pose, r.pose, r.sampling};
  if (!part) return s;
  s.poses.insert(s.poses.end(),
                 {"--frames", words_of(part->frames), "--fps", fmt::format("{}", a.shot.fps)});
  s.time.insert(s.time.end(),
                {"--at", fmt::format("{}", static_cast<double>(part->frames.first) / a.shot.fps)});
  const bool has_quality =
      std::find(s.sampling.begin(), s.sampling.end(), "--quality") != s.sampling.end();
  if (part->moves && !has_quality) s.sampling.insert(s.sampling.end(), {"--quality", "draft"});
  return s;
}

std::vector<Step> stages_of(const Request& r, const Sought& s, const std::string& programs,
                            const std::string& folder) {
  std::vector<Step> stages;
  const auto file = [&](const char* end) { return folder + "/scene." + end; };
  const auto stage = [&](const char* title, const char* tool, const Words& options,
                         const Words& inputs, const char* end) {
    stages.push_back(
        {title, joined({{programs + "/" + tool}, options, r.all, r.stage_flags[stages.size()]}),
         inputs, r.unshaped, file(end)});
  };
  stage("tracing where light goes", "ffgraph", joined({r.cameras, s.poses, r.sky, s.sampling}),
        {r.scene}, "max");
  stage("finding bottlenecks", "mincut", {}, {file("max")}, "cut");
  stage("following the light through them", "lightgrid",
        joined({s.time, r.sky, r.device, s.sampling}), {r.scene, file("cut")}, "vdb");
  stage("fitting portals", "portalfit", {}, {file("vdb")}, "portal.glb");
  return stages;
}

// The scene's name counts, too: it is part of the provenance.
std::string key_of_portals(const Request& r, const Sought& s, const SceneState& state,
                           const std::string& programs) {
  Key key;
  for (const char* tool : {"ffgraph", "mincut", "lightgrid", "portalfit"})
    key.add(content_hash_of_file(programs + "/" + tool));
  key.add(file_name(r.scene));
  key.add(state.hash);
  for (const Words& words :
       {r.cameras, s.poses, by_content(r.sky, state.sky), r.device, s.sampling, r.all})
    key.add(words);
  for (const Words& words : r.stage_flags) {
    key.add(words);
    std::error_code ignored;
    for (const std::string& word : words)
      if (fs::is_regular_file(word, ignored)) key.add(content_hash_of_file(word));
  }
  return key.hash();
}

Search search_of(const Arguments& a, const Request& r, const SceneState& state,
                 const WorkFolder& work, const std::string& programs, const Part* part) {
  const Sought s = sought(a, r, part);
  const std::string entry = "portals-" + key_of_portals(r, s, state, programs);
  Search search{entry, stages_of(r, s, programs, work.path_of(entry)),
                part ? part->frames : FrameRange{}};
  if (part && part->moves)  // there are many
    for (Step& step : search.stages) step.unshaped.emplace_back("--quiet");
  return search;
}

std::vector<Search> searches_of(const Arguments& a, const Request& r, const SceneState& state,
                                const WorkFolder& work, const std::string& programs) {
  if (!r.is_shot) return {search_of(a, r, state, work, programs, nullptr)};
  std::vector<Search> searches;
  for (const Part& part : parts_of_shot(a))
    searches.push_back(search_of(a, r, state, work, programs, &part));
  return searches;
}

// Without the number of samples, of which a film can get more.
Words without_samples(const Words& render) {
  Words words;
  for (size_t i = 0; i < render.size(); ++i) {
    if (render[i] != "--spp") words.push_back(render[i]);
    if (render[i] == "--spp" || render[i] == "--time") ++i;
  }
  return words;
}

// `found`: key of the portals that the stages find; `given`: paths of given ones.
std::string key_of_picture(const Request& r, const SceneState& state, const std::string& found,
                           const Words& given, const std::string& renderer, const Words& render) {
  Key key;
  key.add(content_hash_of_file(renderer));
  key.add(file_name(r.scene));
  key.add(state.hash);
  key.add(found);
  key.add(state.portals);
  for (const std::string& path : given) key.add(file_name(path));
  for (const Words& words : {r.camera, r.pose, r.shot, by_content(r.sky, state.sky), r.device,
                             r.sampling, r.all, render})
    key.add(words);
  return key.hash();
}

// The scene, and portals as options of the renderer.
Words given_to(const Request& r, const Words& portals) {
  Words words{r.scene};
  for (const std::string& path : portals)
    words.insert(words.end(), {"--portal", path.starts_with('-') ? "./" + path : path});
  return words;
}

}  // namespace

Words Step::command(const std::string& to) const {
  return joined({options, unshaped, inputs, {"-o", to}});
}

namespace {

std::string entry_of(const Request& r) {
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(fs::absolute(r.picture, ignored), ignored);
  return "picture-" + content_hash(place.string());
}

// The last stage writes what is asked for.
Pipeline pipeline_of_portals(const Arguments& a, const Request& r, const SceneState& state,
                             const WorkFolder& work, const std::string& programs) {
  Pipeline p;
  p.picture_entry = entry_of(r);
  p.searches = {search_of(a, r, state, work, programs, nullptr)};
  p.key = p.searches[0].entry;
  p.render = p.searches[0].stages.back();
  p.render.output = r.picture;
  p.searches[0].stages.pop_back();
  p.check = joined({{programs + "/tdpt-render"},
                    r.camera,
                    r.pose,
                    r.sky,
                    r.device,
                    r.all,
                    r.unshaped,
                    {r.scene, "-o", "portals.exr", "--check"}});
  return p;
}

}  // namespace

Pipeline pipeline_of(const Arguments& a, const Request& r, const SceneState& state,
                     const WorkFolder& work, const std::string& programs) {
  if (asks_for_portals(r.picture)) return pipeline_of_portals(a, r, state, work, programs);
  Pipeline p;
  const std::string renderer = programs + "/tdpt-render";
  Words portals = a.portals;
  if (!state.drawn.empty()) portals.push_back(state.drawn);
  const Words given = portals;
  p.picture_entry = entry_of(r);
  std::string key_of_found;
  if (portals.empty() && uses_portals(a, state.has_sky)) {
    p.searches = searches_of(a, r, state, work, programs);
    for (const Search& search : p.searches) key_of_found += search.entry;
    if (p.searches.size() > 1)
      p.portals_by_frame = work.path_of(p.picture_entry) + "/frame.######.portal.glb";
    portals.push_back(p.searches.size() > 1 ? p.portals_by_frame : p.searches[0].found());
  }
  const auto key_with = [&](const Words& render) {
    return key_of_picture(r, state, key_of_found, given, renderer, render);
  };
  p.key = key_with(r.render);
  p.film_key = key_with(without_samples(r.render));
  p.counts_samples = a.spp > 0 || a.seconds > 0;
  // Of the frames of a shot the renderer knows itself what is there and whole.
  p.repeatable = a.add_samples == 0 && !r.is_shot;
  p.keeps_film = a.checkpoint.empty() && a.resume.empty() && !r.is_shot;
  Words beside = joined({r.unshaped, r.beside});
  if (p.keeps_film) {
    const std::string film = work.path_of(p.picture_entry) + "/film.exr";
    beside.insert(beside.end(), {"--checkpoint", film, "--resume", film});
  }
  const Words options =
      joined({{renderer}, r.camera, r.pose, r.shot, r.sky, r.device, r.sampling, r.all, r.render});
  p.check =
      joined({Step{"", options, given_to(r, given), beside, ""}.command(r.picture), {"--check"}});
  p.render = {"rendering", options, given_to(r, portals), beside, r.picture};
  return p;
}

std::string shell_text(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + shell_quoted(word);
  return text;
}

}  // namespace tdpt
