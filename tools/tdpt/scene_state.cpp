#include "tools/tdpt/scene_state.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/scene/gltf/defaults.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

// Hash of a file; none if it cannot be read.
std::optional<std::string> hash_of(const std::string& path) {
  std::error_code failed;
  if (!fs::is_regular_file(path, failed)) return {};
  try {
    return content_hash_of_file(path);
  } catch (const InputError&) {
    return {};
  }
}

// Whether the file lies in the folder or below, following links: no other is read.
bool is_below(const fs::path& file, const fs::path& folder) {
  std::error_code failed;
  const fs::path of = fs::canonical(folder, failed), path = fs::canonical(file, failed);
  return !failed && std::mismatch(of.begin(), of.end(), path.begin(), path.end()).first == of.end();
}

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

SceneState state_of(const Arguments& a) {
  SceneState state;
  std::error_code failed;
  if (fs::exists(a.scene, failed) && !fs::is_regular_file(a.scene, failed))  // read more than once
    throw InputError(a.scene, "", "is no regular file, expected a scene (.glb, .gltf)");
  std::string all = content_hash_of_file(a.scene);
  state.files.push_back(a.scene);
  fs::path folder = fs::path(a.scene).parent_path();
  if (folder.empty()) folder = ".";
  const SceneFiles files = files_of_scene(a.scene);
  state.has_sky = files.has_environment;
  for (const std::string& name : files.beside) {
    const std::string path = (folder / name).string();
    const auto hash = is_below(path, folder) ? hash_of(path) : std::nullopt;
    if (hash) state.files.push_back(path);
    all += "\n" + hash.value_or("missing");
  }
  state.hash = content_hash(all);
  const auto add = [&](const std::string& path, std::string& to) {
    if (const auto hash = hash_of(path)) {
      to = *hash;
      state.files.push_back(path);
    }
  };
  add(a.sky.environment, state.sky);
  if (a.portals.empty()) state.drawn = drawn_portals(a.scene);
  for (const std::string& path : a.portals) add(path, state.portals.emplace_back());
  if (!state.drawn.empty()) add(state.drawn, state.portals.emplace_back());
  return state;
}

}  // namespace tdpt
