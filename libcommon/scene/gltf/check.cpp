// Checks types, ranges and references of the JSON by tables: one line per field that this room
// reads. All later code may rely on them.
#include <fmt/format.h>
#include <algorithm>
#include <numbers>

#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/compression.h"

namespace tdpt::gltf {
namespace {

void check_accessors(Checker& c, Json& root) {
  c.each(root, "", "accessors", [&](Json& a, const std::string& at) {
    c.check(a, at,
            {index("bufferView", "bufferViews"), integer("byteOffset"), boolean("normalized"),
             integer("componentType", true), integer("count", true, 1), text("type", true),
             object("sparse")});
    const auto type = a["componentType"].get<uint64_t>();
    if (type < 5120 || type > 5126 || type == 5124)
      c.fail(at + ".componentType", a["componentType"],
             "5120, 5121, 5122, 5123, 5125 or 5126 (float)");
    constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    if (std::find(std::begin(kTypes), std::end(kTypes), a["type"].get<std::string>()) ==
        std::end(kTypes))
      c.fail(at + ".type", a["type"], "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    if (!a.contains("sparse")) return;
    Json& s = a["sparse"];
    c.check(s, at + ".sparse",
            {integer("count", true, 1, kInt), object("indices", true), object("values", true)});
    c.check(s["indices"], at + ".sparse.indices",
            {index("bufferView", "bufferViews", true), integer("byteOffset", false, 0, kInt),
             integer("componentType", true)});
    c.check(s["values"], at + ".sparse.values",
            {index("bufferView", "bufferViews", true), integer("byteOffset", false, 0, kInt)});
  });
}

void check_primitive(Checker& c, Json& root, Json& p, const std::string& at) {
  c.check(
      p, at,
      {object("attributes", true), index("indices", "accessors"), index("material", "materials")});
  check_draco(c, p, at);
  check_attributes(c, p["attributes"], at + ".attributes");
  check_targets(c, p, at);
  if (!p.contains("indices")) return;
  const auto a = p["indices"].get<size_t>();
  if (!root["accessors"][a].contains("bufferView") && !is_draco(p))
    c.fail_missing(place("accessors", a) + ".bufferView", "indices need one");
}

void check_meshes(Checker& c, Json& root) {
  c.each(root, "", "meshes", [&](Json& m, const std::string& at) {
    c.check(m, at, {objects("primitives", true)});
    check_weights(c, m, at);
    c.each(m, at, "primitives", [&](Json& p, const std::string& here) {
      c.check(p, here, {integer("mode", false, 0, 6)});
      if (p.value("mode", 4) >= 4) return check_primitive(c, root, p, here);
      c.tolerate([&] { check_primitive(c, root, p, here); });
      p = {{"attributes", Json::object()}, {"mode", p["mode"]}};  // points, lines: not rendered
    });
  });
}

/// Removes accessors of meshes that are not rendered, since they may be wrong.
void empty_unused_meshes(Checker& c, Json& root) {
  for (size_t i = 0; i < c.size_of("meshes"); ++i)
    if (!c.uses.has("meshes", i)) root["meshes"][i] = harmless("meshes");
}

void check_camera(Checker& c, Json& camera, const std::string& at) {
  c.check(camera, at,
          {name_of("name"), text("type", true), object("perspective"), object("orthographic")});
  const auto type = camera["type"].get<std::string>();
  if (type == "orthographic") {
    // Ignored with a warning; tinygltf requires these fields.
    camera["orthographic"] = {{"xmag", 1}, {"ymag", 1}, {"zfar", 1}, {"znear", 0}};
    return;
  }
  if (type != "perspective") c.fail(at + ".type", camera["type"], "perspective or orthographic");
  c.check(camera, at, {object("perspective", true)});
  Json& p = camera["perspective"];
  c.check(p, at + ".perspective", {number("yfov", true), number("aspectRatio")});
  const double yfov = p["yfov"].get<double>();
  if (!(yfov > 0 && yfov < std::numbers::pi))
    c.fail(at + ".perspective.yfov", p["yfov"], "an angle between 0 and pi");
  if (p.contains("aspectRatio") && !(p["aspectRatio"].get<double>() > 0))
    c.fail(at + ".perspective.aspectRatio", p["aspectRatio"], "more than 0");
  p["znear"] = 1;  // required in files, not used here
  p.erase("zfar");
}

/// Errors of cameras that nodes of the scene hold. The cameras keep their names.
CameraFaults check_cameras(Checker& c, Json& root) {
  CameraFaults faults;
  int i = -1;
  c.each(root, "", "cameras", [&](Json& camera, const std::string& at) {
    ++i;
    try {
      check_camera(c, camera, at);
    } catch (const InputError& e) {
      if (!c.uses.has("cameras", static_cast<size_t>(i))) throw;
      faults[i] = std::make_shared<const InputError>(e);
      const Json name = camera.value("name", Json(""));
      camera = harmless("cameras");
      if (name.is_string()) camera["name"] = name;
    }
  });
  return faults;
}

void check_version(Checker& c, Json& root) {
  c.check(root, "", {object("asset", true)});
  c.check(root["asset"], "asset", {text("version", true)});
  const auto version = root["asset"]["version"].get<std::string>();
  if (version != "2" && !version.starts_with("2."))
    c.fail("asset.version", root["asset"]["version"], "\"2.0\"");
}

/// The parts that exist in every file, whatever the scene uses.
void check_frame(Checker& c, Json& root) {
  check_version(c, root);  // another version may differ in everything else
  c.check(root, "",
          {objects("buffers"), objects("bufferViews"), objects("accessors"), objects("meshes"),
           objects("nodes"), objects("scenes"), objects("cameras"), objects("materials"),
           objects("textures"), objects("images"), objects("samplers"), objects("skins"),
           objects("animations"), index("scene", "scenes")});
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    if (root.contains(list)) {
      if (!root[list].is_array()) c.fail(list, root[list], "an array");
      for (size_t i = 0; i < root[list].size(); ++i)
        if (!root[list][i].is_string()) c.fail(place(list, i), root[list][i], "a string");
    }
  for (const char* section :
       {"scenes", "nodes", "meshes", "skins", "cameras", "materials", "textures", "images",
        "samplers", "accessors", "bufferViews", "buffers"})
    c.uses.count(section, c.size_of(section));
}

void check_buffers(Checker& c, Json& root) {
  mark_views(c.uses, root);
  c.each(root, "", "bufferViews", [&](Json& v, const std::string& at) {
    c.check(v, at,
            {index("buffer", "buffers", true), integer("byteOffset"),
             integer("byteLength", true, 1), integer("byteStride", false, 4, 252)});
    check_meshopt_view(c, v, at);
  });
  mark_buffers(c.uses, root);
  c.each(root, "", "buffers", [&](Json& b, const std::string& at) {
    c.check(b, at, {integer("byteLength", true, 1), text("uri")});
    check_meshopt_buffer(c, b, at);
  });
}

}  // namespace

Checked check_json(Json& root, const std::string& file,
                   const std::vector<std::string>& animations) {
  Checker c(root, file);
  check_frame(c, root);
  count_lights(c, root);
  check_nodes(c, root);
  check_lights(c, root);
  check_skins(c, root);
  check_nodes_outside(c, root);
  check_meshes(c, root);
  empty_unused_meshes(c, root);
  const CameraFaults cameras = check_cameras(c, root);
  mark_parts_of_meshes(c.uses, root);
  check_materials(c, root);
  check_textures(c, root);
  check_animations(c, root, animations);
  check_accessors(c, root);
  check_buffers(c, root);
  return {c.warnings(), c.uses.of("buffers"), cameras};
}

}  // namespace tdpt::gltf
