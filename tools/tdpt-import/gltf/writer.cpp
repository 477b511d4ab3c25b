#include "tools/tdpt-import/gltf/gltf.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/portal.h"
#include "tdpt_version.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {

// ---- The binary part ----

namespace {

std::string text_of(const GltfJson& json) {
  return json.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
}

template <class Index>
size_t add_indices(GltfFile& f, const Mesh& mesh, bool turned, Glb<GltfJson>::Component component) {
  std::vector<Index> corners;
  for (auto [a, b, c] : mesh.triangles) {
    if (turned) std::swap(b, c);
    for (const uint32_t i : {a, b, c}) corners.push_back(static_cast<Index>(i));
  }
  return f.glb.add_accessor(corners, corners.size(), "SCALAR", component, f.glb.indices);
}

}  // namespace

size_t GltfFile::index_of(const char* section, const GltfJson& value) {
  std::map<std::string, size_t>& all = known[section];
  const auto [it, is_new] = all.try_emplace(text_of(value), all.size());
  if (is_new) glb.add(section, value);
  return it->second;
}

GltfJson& GltfFile::extension(GltfJson& object, const char* name) {
  extensions.insert(name);
  return object["extensions"][name];
}

namespace {

// ---- The frame ----

// The frame that mirrors the scene along x if its first camera is mirrored, and turns `up` to +y.
// "auto" takes the axis that is nearest to what is up in the camera's picture.
Frame frame_of(const Described& scene, const std::string& up) {
  Frame frame;
  if (up != "auto") frame.up = up;
  if (!scene.cameras.empty()) {
    const Affine& camera = scene.cameras.front().to_world;
    frame.mirrored = camera.mirrors();
    if (up == "auto") {
      const Vec3d& y = camera.y;
      const double x = std::abs(y.x), z = std::abs(y.z), upright = std::abs(y.y);
      frame.up = upright >= x && upright >= z ? "y" : z >= x ? "z" : "x";
      frame.downwards = (frame.up == "y" ? y.y : frame.up == "z" ? y.z : y.x) < 0;
    }
  }
  // These rotations take the axis to +y and keep one of the others.
  Affine turn;
  if (frame.up == "z") turn = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}};
  if (frame.up == "x") turn = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {}};
  if (frame.downwards) turn = Affine{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}} * turn;
  if (frame.mirrored) turn = turn * Affine{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
  frame.to_gltf = turn;
  return frame;
}

constexpr double kShear = 1e-5;  // cosine between axes that still counts as a right angle

GltfJson three(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

// The unit quaternion x, y, z, w of a rotation.
std::array<double, 4> quaternion_of(const Affine& r) {
  const double trace = r.x.x + r.y.y + r.z.z;
  std::array<double, 4> q;
  if (trace > 0) {
    q = {r.y.z - r.z.y, r.z.x - r.x.z, r.x.y - r.y.x, 1 + trace};
  } else if (r.x.x >= r.y.y && r.x.x >= r.z.z) {
    q = {1 + r.x.x - r.y.y - r.z.z, r.x.y + r.y.x, r.z.x + r.x.z, r.y.z - r.z.y};
  } else if (r.y.y >= r.z.z) {
    q = {r.x.y + r.y.x, 1 - r.x.x + r.y.y - r.z.z, r.y.z + r.z.y, r.z.x - r.x.z};
  } else {
    q = {r.z.x + r.x.z, r.y.z + r.z.y, 1 - r.x.x - r.y.y + r.z.z, r.x.y - r.y.x};
  }
  const double l = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& v : q) v /= l;
  return q;
}

// Writes translation, rotation and scale; returns false if the map shears or flattens.
bool put_trs(const Affine& m, GltfJson& node) {
  Vec3d scale{length(m.x), length(m.y), length(m.z)};
  if (!(scale.x > 0 && scale.y > 0 && scale.z > 0)) return false;
  Affine r{m.x / scale.x, m.y / scale.y, m.z / scale.z, {}};
  if (std::max({std::abs(dot(r.x, r.y)), std::abs(dot(r.y, r.z)), std::abs(dot(r.z, r.x))}) >
      kShear)
    return false;
  if (r.mirrors()) r.z = -r.z, scale.z = -scale.z;
  const auto q = quaternion_of(r);
  if (m.t.x != 0 || m.t.y != 0 || m.t.z != 0) node["translation"] = three(m.t);
  if (q[0] != 0 || q[1] != 0 || q[2] != 0) node["rotation"] = q;
  if (scale.x != 1 || scale.y != 1 || scale.z != 1) node["scale"] = three(scale);
  return true;
}

// Applies to a mesh a map that a node cannot have.
Mesh baked(const Mesh& mesh, const Affine& m) {
  Mesh out = mesh;
  for (Vec3f& p : out.positions) p = in_single(m.point(in_double(p)));
  const double sign = m.mirrors() ? -1 : 1;
  const Affine normals{cross(m.y, m.z) * sign, cross(m.z, m.x) * sign, cross(m.x, m.y) * sign, {}};
  for (Vec3f& n : out.normals) n = in_single(normals.vector(in_double(n)));
  if (m.mirrors())
    for (auto& t : out.triangles) std::swap(t[1], t[2]);
  return out;
}

// ---- The sections ----

void add_node(GltfFile& f, GltfJson node) {
  const size_t index = f.glb.add("nodes", std::move(node));
  f.glb.root["scenes"][0]["nodes"].push_back(index);
}

void add_camera(GltfFile& f, const Camera& camera) {
  const Affine m = f.out.frame.to_gltf * camera.to_world;
  const double aspect = static_cast<double>(camera.width) / std::max(camera.height, 1);
  const size_t index = f.glb.add(
      "cameras",
      {{"name", shown(camera.name, 200)},
       {"type", "perspective"},
       {"perspective", {{"yfov", camera.yfov}, {"aspectRatio", aspect}, {"znear", 0.01}}}});
  if (camera.lens_radius > 0) {
    // As tdpt has it: a film 36 mm along its longer side.
    const double focal = 0.018 / (std::tan(camera.yfov / 2) * std::max(1.0, aspect));
    f.lose(fmt::format(
        "depth of field is no part of glTF: give --f-stop {:.4g} --focus {:.4g} to tdpt",
        focal / (2 * camera.lens_radius), camera.focus_distance));
  }
  if (camera.shift_x != 0 || camera.shift_y != 0) f.lose("the shift of the camera is left out");
  // Makes the axes exactly perpendicular; y stays up in the picture.
  const Vec3d z = normalize(m.z), x = normalize(cross(m.y, z));
  GltfJson node = {{"name", shown(camera.name, 200)}, {"camera", index}};
  put_trs({x, cross(z, x), z, m.t}, node);
  add_node(f, std::move(node));
}

void add_lamp(GltfFile& f, const Lamp& lamp) {
  const float strength = max_component(lamp.intensity);
  if (!(strength > 0)) return;
  const Rgb colour = max(lamp.intensity, Rgb(0)) / strength;
  GltfJson light = {{"name", shown(lamp.name, 200)},
                    {"type", lamp.kind == Lamp::Kind::point  ? "point"
                             : lamp.kind == Lamp::Kind::spot ? "spot"
                                                             : "directional"},
                    {"color", {colour.x, colour.y, colour.z}},
                    {"intensity", strength}};
  if (lamp.kind == Lamp::Kind::spot)
    light["spot"] = {
        {"innerConeAngle", std::clamp(lamp.inner, 0.0, std::min(lamp.outer, 1.57) - 1e-4)},
        {"outerConeAngle", std::clamp(lamp.outer, 1e-3, 1.57)}};
  GltfJson& lights = f.extension(f.glb.root, "KHR_lights_punctual")["lights"];
  lights.push_back(std::move(light));
  GltfJson node = {{"name", shown(lamp.name, 200)},
                   {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
  Affine m;
  if (lamp.kind != Lamp::Kind::point) {
    const Onb<double> frame(-normalize(f.out.frame.to_gltf.vector(lamp.towards)));
    m = {frame.x, frame.y, frame.z, {}};
  }
  m.t = lamp.kind == Lamp::Kind::sun ? Vec3d(0) : f.out.frame.to_gltf.point(lamp.at);
  put_trs(m, node);
  add_node(f, std::move(node));
}

// The index of a shape's mesh in glTF. Shapes with the same `number` have the same `mesh`.
size_t mesh_of(GltfFile& f, const Shape& shape, const Mesh& mesh, size_t number) {
  const auto [material, is_textured] = material_index(f, shape.material, shape.emission);
  const std::array<size_t, 3> key{number, material, shape.turned};
  if (const auto it = f.meshes.find(key); it != f.meshes.end()) return it->second;
  enum Attribute : size_t { kPosition, kNormal, kTexcoord, kIndex };
  const auto accessor = [&](Attribute attribute, bool turned, const auto& make) {
    const std::array<size_t, 3> of{attribute, number, turned};
    const auto it = f.accessors.find(of);
    return it != f.accessors.end() ? it->second : f.accessors[of] = make();
  };
  GltfJson primitive;
  GltfJson& attributes = primitive["attributes"];
  attributes["POSITION"] =
      accessor(kPosition, false, [&] { return f.glb.add_positions(mesh.positions); });
  if (mesh.normals.size() == mesh.positions.size())
    attributes["NORMAL"] = accessor(kNormal, shape.turned, [&] {
      Mesh checked = mesh;
      check(checked, f.source.path());  // scales normals to length 1
      checked.normals.resize(mesh.positions.size(), {0, 0, 1});
      if (shape.turned)
        for (Vec3f& n : checked.normals) n = -n;
      return f.glb.add_vectors(checked.normals);
    });
  if (is_textured && mesh.uv.size() == mesh.positions.size())
    attributes["TEXCOORD_0"] = accessor(kTexcoord, false, [&] {
      return f.glb.add_accessor(mesh.uv, mesh.uv.size(), "VEC2", f.glb.float32, f.glb.vertices);
    });
  primitive["indices"] = accessor(kIndex, shape.turned, [&] {
    return mesh.positions.size() > 65535
               ? add_indices<uint32_t>(f, mesh, shape.turned, f.glb.uint32)
               : add_indices<uint16_t>(f, mesh, shape.turned, f.glb.uint16);
  });
  primitive["material"] = material;
  GltfJson out;
  if (!shape.name.empty()) out["name"] = shown(shape.name, 200);
  out["primitives"] = GltfJson::array({std::move(primitive)});
  return f.meshes[key] = f.glb.add("meshes", std::move(out));
}

void add_shape(GltfFile& f, const Shape& shape) {
  if (f.scene.materials[shape.material].invisible && !shape.emission) return;
  const Mesh& mesh = f.scene.meshes[shape.mesh];
  if (mesh.triangles.empty()) return;
  const Affine m = f.out.frame.to_gltf * shape.to_world;
  GltfJson node;
  if (!shape.name.empty()) node["name"] = shown(shape.name, 200);
  GltfJson placed = node;
  if (put_trs(m, placed)) {
    placed["mesh"] = mesh_of(f, shape, mesh, shape.mesh);
    add_node(f, std::move(placed));
  } else {
    node["mesh"] = mesh_of(f, shape, baked(mesh, m), f.scene.meshes.size() + f.out.shapes);
    add_node(f, std::move(node));
  }
  ++f.out.shapes;
  f.out.triangles += mesh.triangles.size();
  if (shape.emission) f.out.emitters += mesh.triangles.size();
}

// Turns the fronts of portals to the first camera. Light passes both ways through a portal whose
// front was on the other side in the source.
void add_portals(GltfFile& f) {
  PortalFile file;
  file.provenance = f.how.provenance;
  for (const Shape& shape : f.scene.portals) {
    const Mesh mesh = baked(f.scene.meshes[shape.mesh], f.out.frame.to_gltf * shape.to_world);
    Portal portal;
    for (const Vec3f& p : mesh.positions) {
      if (!(length(in_double(p)) < 1e30))
        throw InputError(f.source.path(), "", "has a portal that is too large or too far away");
      portal.vertices.push_back(in_double(p));
    }
    for (const auto& t : mesh.triangles)
      if (length(front_of(mesh, t)) > 0) portal.triangles.push_back(t);
    if (portal.triangles.empty()) {
      f.lose("a portal without an area is left out");
      continue;
    }
    double towards_camera = shape.turned ? -1 : 1;
    if (!f.scene.cameras.empty()) {
      const Vec3d eye = f.out.frame.to_gltf.point(f.scene.cameras.front().to_world.t);
      double sum = 0;
      for (const auto& t : portal.triangles)
        sum += dot(front_of(mesh, t), eye - portal.vertices[t[0]]);
      portal.both_ways = sum * towards_camera < 0;
      towards_camera = sum;
    }
    if (towards_camera < 0)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
    file.portals.push_back(std::move(portal));
  }
  if (!file.portals.empty()) f.out.portals = portal_bytes(file);
}

}  // namespace

GltfOutput write_gltf(const Described& scene, const GltfOptions& writing, Source& source) {
  GltfFile f{scene, writing, source};
  f.out.frame = frame_of(scene, writing.up);
  GltfJson& root = f.glb.root;
  root["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
  root["asset"]["extras"]["source"] = writing.format;
  if (!writing.provenance.empty()) root["asset"]["extras"]["provenance"] = writing.provenance.lines;
  root["scene"] = 0;
  root["scenes"] = GltfJson::array({GltfJson::object()});
  if (!scene.title.empty()) root["scenes"][0]["name"] = shown(scene.title, 200);
  for (const Camera& c : scene.cameras) add_camera(f, c);
  for (const Lamp& l : scene.lamps) add_lamp(f, l);
  for (const Shape& s : scene.shapes) add_shape(f, s);
  GltfJson extras = GltfJson::object();
  if (!scene.cameras.empty() && scene.cameras.front().width > 0) {
    extras["tdpt_width"] = scene.cameras.front().width;
    extras["tdpt_height"] = scene.cameras.front().height;
  }
  add_sky(f, extras);
  if (!extras.empty()) root["scenes"][0]["extras"] = std::move(extras);
  add_portals(f);
  if (!f.extensions.empty()) root["extensionsUsed"] = f.extensions;
  f.out.materials = root.contains("materials") ? root["materials"].size() : 0;
  f.out.textures = root.contains("images") ? root["images"].size() : 0;
  f.out.glb = f.glb.file();
  return std::move(f.out);
}

}  // namespace tdpt::foreign
