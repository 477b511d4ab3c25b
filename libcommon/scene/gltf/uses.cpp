#include "libcommon/scene/gltf/checker.h"

#include <algorithm>
#include <array>

#include "libcommon/scene/gltf/compression.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

/// Calls `visit(element)` for each used element of a section.
template <class Visit>
void each_used(const Uses& uses, const Json& root, const char* section, const Visit& visit) {
  const auto it = root.find(section);
  if (it == root.end()) return;
  for (size_t i = 0; i < it->size(); ++i)
    if (uses.has(section, i)) visit((*it)[i]);
}

/// Marks the indices in every member called `name` at any depth, including all extensions. Other
/// checks report values that are no index.
void mark_all(Uses& uses, const Json& value, const char* name, const char* section) {
  std::vector<const Json*> next{&value};
  while (!next.empty()) {
    const Json& v = *next.back();
    next.pop_back();
    if (!v.is_structured()) continue;
    if (const auto it = v.is_object() ? v.find(name) : v.end();
        it != v.end() && it->is_number_unsigned())
      uses.mark(section, it->get<size_t>());
    for (const Json& inner : v) next.push_back(&inner);
  }
}

void mark_attributes(Uses& uses, const Json& attributes) {
  for (const Json& accessor : attributes) uses.mark("accessors", accessor.get<size_t>());
}

}  // namespace

bool Uses::mark(const std::string& section, size_t index) {
  std::vector<bool>& used = used_[section];
  if (index >= used.size() || used[index]) return false;
  return used[index] = true;
}

bool Uses::has(const std::string& section, size_t index) const {
  const auto it = used_.find(section);
  return it == used_.end() || (index < it->second.size() && it->second[index]);
}

bool is_read_attribute(const std::string& name) {
  constexpr std::array kRead = {"POSITION",   "NORMAL",     "TANGENT",
                                "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
         std::find(kRead.begin(), kRead.end(), name) != kRead.end();
}

Json harmless(const std::string& section) {
  if (section == "accessors") return {{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
  if (section == "bufferViews") return {{"buffer", 0}, {"byteLength", 1}};
  if (section == "buffers") return {{"byteLength", 1}};
  if (section == "meshes") return {{"primitives", Json::array()}};
  if (section == "cameras")
    return {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}};
  if (section == "lights") return {{"type", "point"}, {"intensity", 0}};
  if (section == "EXT_lights_area") return {{"type", "rect"}, {"intensity", 0}};
  if (section == "skins") return {{"joints", {0}}};
  return Json::object();
}

void mark_parts_of_meshes(Uses& uses, const Json& root) {
  each_used(uses, root, "meshes", [&](const Json& mesh) {
    for (const Json& p : mesh["primitives"]) {
      if (p.value("mode", 4) < 4) continue;  // points and lines, which are not rendered
      if (p.contains("material")) uses.mark("materials", p["material"].get<size_t>());
      if (p.contains("indices")) uses.mark("accessors", p["indices"].get<size_t>());
      mark_attributes(uses, p["attributes"]);
      for (const Json& target : p.value("targets", Json::array())) mark_attributes(uses, target);
      mark_all(uses, p, "bufferView", "bufferViews");
    }
  });
}

void mark_parts_of_textures(Uses& uses, const Json& root) {
  each_used(uses, root, "textures", [&](const Json& t) {
    mark_all(uses, t, "source", "images");
    mark_all(uses, t, "sampler", "samplers");
  });
}

void mark_views(Uses& uses, const Json& root) {
  for (const char* section : {"accessors", "images"})
    each_used(uses, root, section,
              [&](const Json& e) { mark_all(uses, e, "bufferView", "bufferViews"); });
}

void mark_buffers(Uses& uses, const Json& root) {
  each_used(uses, root, "bufferViews", [&](const Json& v) {
    const Json extensions = v.value("extensions", Json::object());
    for (const char* name : kMeshopt)  // then the view's own buffer is a fallback
      if (extensions.contains(name))
        return uses.mark("buffers", extensions[name]["buffer"].get<size_t>()), void();
    uses.mark("buffers", v["buffer"].get<size_t>());
  });
}

}  // namespace tdpt::gltf
