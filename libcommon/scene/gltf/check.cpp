// Checks types, ranges and references of the JSON by tables: one line per field that this room
// reads. All later code may rely on them.
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <numbers>

#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/compression.h"
#include "libcommon/scene/gltf/document.h"

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
      check_primitive(c, root, p, here);
      if (p.value("mode", 4) < 4)
        p = {{"attributes", Json::object()}, {"mode", p["mode"]}};  // points, lines: not rendered
    });
  });
}

void check_camera(Checker& c, Json& camera, const std::string& at) {
  c.check(camera, at,
          {text("name"), text("type", true), object("perspective"), object("orthographic")});
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

void check_cameras(Checker& c, Json& root) {
  c.each(root, "", "cameras",
         [&](Json& camera, const std::string& at) { check_camera(c, camera, at); });
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
  for (const char* name : {"KHR_lights_punctual", "EXT_lights_ies", "EXT_lights_area"})
    c.check_extension(root, "", name, {objects("lights")});
  for (const char* list : {"extensionsUsed", "extensionsRequired"})
    if (root.contains(list)) {
      if (!root[list].is_array()) c.fail(list, root[list], "an array");
      for (size_t i = 0; i < root[list].size(); ++i)
        if (!root[list][i].is_string()) c.fail(place(list, i), root[list][i], "a string");
    }
}

void check_buffers(Checker& c, Json& root) {
  c.each(root, "", "bufferViews", [&](Json& v, const std::string& at) {
    c.check(v, at,
            {index("buffer", "buffers", true), integer("byteOffset"),
             integer("byteLength", true, 1), integer("byteStride", false, 4, 252)});
    check_meshopt_view(c, v, at);
  });
  c.each(root, "", "buffers", [&](Json& b, const std::string& at) {
    c.check(b, at, {integer("byteLength", true, 1), text("uri")});
    check_meshopt_buffer(c, b, at);
  });
}

}  // namespace

std::vector<std::string> check_json(Json& root, const std::string& file,
                                    const std::vector<std::string>& animations) {
  Checker c(root, file);
  check_frame(c, root);
  check_nodes(c, root);
  check_lights(c, root);
  check_skins(c, root);
  check_meshes(c, root);
  check_cameras(c, root);
  check_materials(c, root);
  check_textures(c, root);
  check_animations(c, root, animations);
  check_accessors(c, root);
  check_buffers(c, root);
  return c.notes();
}

/// What the scene reads of a primitive or a morph target.
bool is_read_attribute(const std::string& name) {
  constexpr std::array kRead = {"POSITION",   "NORMAL",     "TANGENT",
                                "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
         std::find(kRead.begin(), kRead.end(), name) != kRead.end();
}

namespace {

/// Element sizes that meshoptimizer requires in its modes and filters.
void check_meshopt_stride(Checker& c, const Json& e, const std::string& at) {
  const auto stride = e["byteStride"].get<uint64_t>();
  const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
  const auto expect = [&](bool right, const char* expected) {
    if (!right) c.fail(at + ".byteStride", e["byteStride"], expected);
  };
  if (mode != "ATTRIBUTES") {
    expect(stride == 2 || stride == 4, "2 or 4, the bytes of an index");
    if (filter != "NONE") c.fail(at + ".filter", e["filter"], "NONE where there are indices");
    return;
  }
  expect(stride % 4 == 0, "a multiple of 4");
  if (filter == "OCTAHEDRAL") expect(stride == 4 || stride == 8, "4 or 8 with this filter");
  if (filter == "QUATERNION") expect(stride == 8, "8 with this filter");
}

}  // namespace

void check_draco(Checker& c, Json& p, const std::string& at) {
  Json* const e = c.check_extension(
      p, at, kDraco, {index("bufferView", "bufferViews", true), object("attributes", true)});
  if (!e) return;
  Json& ids = (*e)["attributes"];
  std::erase_if(ids.get_ref<Json::object_t&>(),
                [](const auto& a) { return !is_read_attribute(a.first); });
  for (const auto& [name, value] : ids.items()) {
    c.check(ids, at + ".extensions." + kDraco + ".attributes",
            {integer(name.c_str(), true, 0, 4294967295.0)});
    if (!p["attributes"].contains(name))
      c.fail_missing(at + ".attributes." + name.substr(0, 60), "but is compressed by Draco");
  }
  if (!p.contains("indices") && p.value("mode", 4) >= 4)
    c.fail_missing(at + ".indices", "meshes compressed by Draco have some");
}

void check_meshopt_buffer(Checker& c, Json& buffer, const std::string& at) {
  for (const char* name : kMeshopt) c.check_extension(buffer, at, name, {boolean("fallback")});
}

void check_meshopt_view(Checker& c, Json& view, const std::string& at) {
  for (const char* name : kMeshopt) {
    const Json* const extension =
        c.check_extension(view, at, name,
                          {index("buffer", "buffers", true), integer("byteOffset"),
                           integer("byteLength", true, 1), integer("byteStride", true, 1, 256),
                           integer("count", true, 1), text("mode", true), text("filter")});
    if (!extension) continue;
    const Json& e = *extension;
    const std::string here = at + ".extensions." + name;
    const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
    if (mode != "ATTRIBUTES" && mode != "TRIANGLES" && mode != "INDICES")
      c.fail(here + ".mode", e["mode"], "ATTRIBUTES, TRIANGLES or INDICES");
    if (filter != "NONE" && filter != "OCTAHEDRAL" && filter != "QUATERNION" &&
        filter != "EXPONENTIAL")
      c.fail(here + ".filter", e["filter"], "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
    check_meshopt_stride(c, e, here);
    if (view.contains("byteStride") && view["byteStride"] != e["byteStride"])
      c.fail(here + ".byteStride", e["byteStride"],
             fmt::format("{} as of the bufferView", view["byteStride"].get<uint64_t>()));
    if (mode == "TRIANGLES" && e["count"].get<uint64_t>() % 3 != 0)
      c.fail(here + ".count", e["count"], "a multiple of 3");
  }
}

// Extensions by name: those that are read, and those that a renderer of still pictures may ignore
// even if a file requires them.

namespace {

constexpr std::array kSupported = {"KHR_materials_emissive_strength",
                                   "KHR_materials_specular",
                                   "KHR_materials_ior",
                                   "KHR_materials_transmission",
                                   "KHR_materials_volume",
                                   "KHR_materials_clearcoat",
                                   "KHR_materials_sheen",
                                   "KHR_materials_iridescence",
                                   "KHR_materials_anisotropy",
                                   "KHR_materials_dispersion",
                                   "KHR_materials_diffuse_transmission",
                                   "KHR_materials_volume_scatter",
                                   "KHR_materials_unlit",
                                   "KHR_lights_punctual",
                                   "EXT_lights_ies",
                                   "EXT_lights_area",
                                   "KHR_mesh_quantization",
                                   "KHR_draco_mesh_compression",
                                   "EXT_meshopt_compression",
                                   "KHR_meshopt_compression",
                                   "EXT_texture_webp",
                                   "EXT_texture_avif",
                                   "KHR_texture_basisu",
                                   "MSFT_texture_dds",
                                   "KHR_texture_transform",
                                   "KHR_materials_pbrSpecularGlossiness",
                                   "KHR_node_visibility",
                                   "EXT_mesh_gpu_instancing"};

constexpr std::array kOfNoPicture = {
    // Alternative materials and levels of detail: what the nodes refer to is rendered.
    "KHR_materials_variants", "MSFT_lod",
    // Animates properties outside of nodes; only animations of nodes are evaluated.
    "KHR_animation_pointer",
    // Interaction.
    "KHR_interactivity", "KHR_node_hoverability", "KHR_node_selectability", "AGI_articulations",
    // Metadata.
    "KHR_xmp", "KHR_xmp_json_ld", "AGI_stk_metadata", "EXT_feature_metadata",
    "EXT_instance_features", "EXT_mesh_features", "EXT_structural_metadata", "FB_geometry_metadata",
    "VRM", "VRMC_node_constraint", "VRMC_springBone", "VRMC_vrm",
    // Physics and sound.
    "KHR_audio_emitter", "KHR_physics_rigid_bodies", "MSFT_audio_emitter", "OMI_collider",
    "OMI_physics_body", "OMI_physics_joint", "OMI_physics_shape",
    // Modelling history, and the drawing order of rasterisers.
    "ADOBE_render_order", "CESIUM_primitive_outline", "EXT_mesh_manifold", "FB_ngon_encoding",
    "GODOT_single_root",
    // An offset of the whole scene, cameras and lamps included.
    "CESIUM_RTC"};

}  // namespace

bool is_supported(const std::string& extension) {
  return std::find(kSupported.begin(), kSupported.end(), extension) != kSupported.end();
}

bool changes_no_picture(const std::string& extension) {
  return std::find(kOfNoPicture.begin(), kOfNoPicture.end(), extension) != kOfNoPicture.end();
}

}  // namespace tdpt::gltf
