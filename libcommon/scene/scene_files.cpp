#include "libcommon/scene/scene_files.h"

#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf_document.h"

namespace tdpt {

std::vector<std::string> files_beside(const std::string& scene) {
  std::vector<std::string> names;
  const auto add = [&](const nlohmann::json& uri) {
    if (!uri.is_string()) return;
    const std::string text = uri.get<std::string>();
    if (text.starts_with("data:")) return;
    const std::string name = gltf::percent_decode(text);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  const std::string bytes = read_file(scene);
  try {
    std::vector<std::string> ignored;
    const nlohmann::json json =
        gltf::parse_json(gltf::split_chunks(bytes, scene, ignored).json, scene);
    for (const char* section : {"buffers", "images"})
      for (const nlohmann::json& one : json.value(section, nlohmann::json::array()))
        if (one.is_object() && one.contains("uri")) add(one["uri"]);
  } catch (const InputError&) {
  } catch (const nlohmann::json::exception&) {
  }
  return names;
}

}  // namespace tdpt
