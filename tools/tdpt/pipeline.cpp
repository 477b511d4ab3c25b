#include "tools/tdpt/pipeline.h"

#include <filesystem>

#include "libcommon/base/hash.h"
#include "libcommon/base/shell_quoted.h"

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

void add_stages(const Request& r, const std::string& programs, const std::string& folder,
                Pipeline& p) {
  const auto file = [&](const char* end) { return folder + "/scene." + end; };
  const auto stage = [&](size_t i, const char* title, const char* tool, const Words& options,
                         const Words& inputs, const char* end) {
    p.stages.push_back({title, joined({{programs + "/" + tool}, options, r.all, r.stage_flags[i]}),
                        inputs, r.unshaped, file(end)});
  };
  stage(0, "tracing where light goes", "ffgraph",
        joined({r.cameras, r.portal_poses, r.sky, r.sampling}), {r.scene}, "max");
  stage(1, "finding bottlenecks", "mincut", {}, {file("max")}, "cut");
  stage(2, "following the light through them", "lightgrid",
        joined({r.portal_time, r.sky, r.device, r.sampling}), {r.scene, file("cut")}, "vdb");
  stage(3, "fitting portals", "portalfit", {}, {file("vdb")}, "portal.glb");
}

// The scene's name counts, too: it is part of the provenance.
std::string key_of_portals(const Request& r, const SceneState& state, const std::string& programs) {
  Key key;
  for (const char* tool : {"ffgraph", "mincut", "lightgrid", "portalfit"})
    key.add(content_hash_of_file(programs + "/" + tool));
  key.add(file_name(r.scene));
  key.add(state.hash);
  for (const Words& words :
       {r.cameras, r.portal_poses, by_content(r.sky, state.sky), r.device, r.sampling, r.all})
    key.add(words);
  for (const Words& words : r.stage_flags) {
    key.add(words);
    std::error_code ignored;
    for (const std::string& word : words)
      if (fs::is_regular_file(word, ignored)) key.add(content_hash_of_file(word));
  }
  return key.hash();
}

// `found`: key of the portals that the stages find; `given`: paths of given ones.
std::string key_of_picture(const Request& r, const SceneState& state, const std::string& found,
                           const Words& given, const std::string& renderer) {
  Key key;
  key.add(content_hash_of_file(renderer));
  key.add(file_name(r.scene));
  key.add(state.hash);
  key.add(found);
  key.add(state.portals);
  for (const std::string& path : given) key.add(file_name(path));
  for (const Words& words : {r.camera, r.pose, r.shot, by_content(r.sky, state.sky), r.device,
                             r.sampling, r.all, r.render})
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

Pipeline pipeline_of(const Arguments& a, const Request& r, const SceneState& state,
                     const WorkFolder& work, const std::string& programs) {
  Pipeline p;
  const std::string renderer = programs + "/tdpt-render";
  Words portals = a.portals;
  if (!state.drawn.empty()) portals.push_back(state.drawn);
  const Words given = portals;
  std::string key_of_found;
  if (portals.empty() && uses_portals(a, state.has_sky)) {
    key_of_found = key_of_portals(r, state, programs);
    p.portals_entry = "portals-" + key_of_found;
    add_stages(r, programs, work.path_of(p.portals_entry), p);
    portals.push_back(p.stages.back().output);
  }
  p.key = key_of_picture(r, state, key_of_found, given, renderer);
  std::error_code ignored;
  const fs::path place = fs::weakly_canonical(fs::absolute(r.picture, ignored), ignored);
  p.picture_entry = "picture-" + content_hash(place.string());
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
