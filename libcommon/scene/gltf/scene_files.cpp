#include "libcommon/scene/gltf/scene_files.h"

#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/defaults.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/uri.h"

namespace tdpt {
namespace {

void add(const std::string& name, std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

void add_uris(const nlohmann::json& gltf, std::vector<std::string>& names) {
  using Pointer = nlohmann::json::json_pointer;
  for (const char* list : {"/buffers", "/images", "/extensions/EXT_lights_ies/lights"})
    for (const nlohmann::json& one : gltf.value(Pointer(list), nlohmann::json::array())) {
      if (!one.is_object() || !one.contains("uri") || !one["uri"].is_string()) continue;
      const std::string uri = one["uri"].get<std::string>();
      if (!uri.starts_with("data:")) add(gltf::percent_decode(uri), names);
    }
}

}  // namespace

SceneFiles files_of_scene(const std::string& path) {
  SceneFiles files;
  const std::string bytes = read_file(path);
  try {
    std::vector<std::string> ignored;
    const nlohmann::json json =
        gltf::parse_json(gltf::split_chunks(bytes, path, ignored).json, path);
    add_uris(json, files.beside);
    const SceneDefaults defaults = defaults_of(json, path);
    files.has_environment = defaults.has_environment();
    if (files.has_environment)  // the name as written, or decoded; a colour is no file
      for (const std::string& name :
           {defaults.environment, gltf::percent_decode(defaults.environment)})
        add(name, files.beside);
  } catch (const InputError&) {
  } catch (const nlohmann::json::exception&) {
  }
  return files;
}

}  // namespace tdpt
