#include "tools/tdpt-import/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/portal.h"
#include "tdpt_version.h"

namespace tdpt::foreign {

// ---- The binary part ----

namespace {

constexpr int kFloat = 5126, kShort = 5123, kInt = 5125, kVertices = 34962, kIndices = 34963;

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

size_t Glb::bytes(std::string_view bytes, int target) {
  GltfJson v = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
  if (target) v["target"] = target;
  root["bufferViews"].push_back(std::move(v));
  bin_ += bytes;
  bin_.resize((bin_.size() + 3) / 4 * 4);
  return root["bufferViews"].size() - 1;
}

size_t Glb::accessor(std::string_view values, int target, int type, size_t count,
                     const char* shape) {
  const size_t view = bytes(values, target);
  root["accessors"].push_back(
      {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
  return root["accessors"].size() - 1;
}

size_t Glb::positions(const std::vector<Vec3f>& values) {
  Vec3f low(std::numeric_limits<float>::infinity()), high = -low;
  for (const Vec3f& p : values) low = min(low, p), high = max(high, p);
  const size_t at = normals(values);
  root["accessors"][at]["min"] = {low.x, low.y, low.z};
  root["accessors"][at]["max"] = {high.x, high.y, high.z};
  return at;
}

size_t Glb::normals(const std::vector<Vec3f>& values) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  return accessor(bytes_of(values), kVertices, kFloat, values.size(), "VEC3");
}

size_t Glb::uv(const std::vector<std::array<float, 2>>& values) {
  return accessor(bytes_of(values), kVertices, kFloat, values.size(), "VEC2");
}

size_t Glb::indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices) {
  if (vertices > 65535)
    return accessor(bytes_of(triangles), kIndices, kInt, 3 * triangles.size(), "SCALAR");
  std::vector<uint16_t> small;
  for (const auto& t : triangles)
    for (const uint32_t i : t) small.push_back(static_cast<uint16_t>(i));
  return accessor(bytes_of(small), kIndices, kShort, small.size(), "SCALAR");
}

std::string Glb::file() {
  constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
  if (!bin_.empty()) root["buffers"] = GltfJson::array({{{"byteLength", bin_.size()}}});
  std::string text = root.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const size_t total = 12 + 8 + text.size() + (bin_.empty() ? 0 : 8 + bin_.size());
  if (total > std::numeric_limits<uint32_t>::max())
    throw Error(Exit::bad_input, "the scene takes more than 4 GiB, which no .glb holds");
  std::string glb;
  glb.reserve(total);
  const auto word = [&](size_t v) {
    const auto word32 = static_cast<uint32_t>(v);
    glb.append(reinterpret_cast<const char*>(&word32), sizeof word32);
  };
  word(kGlbMagic), word(2), word(total), word(text.size()), word(kJsonChunk);
  glb += text;
  if (!bin_.empty()) {
    word(bin_.size()), word(kBinChunk);
    glb += bin_;
  }
  return glb;
}

namespace {

// ---- The frame ----

// Mirrors the scene along x if its first camera is mirrored, and turns `up` to +y. By the camera:
// the axis that is nearest to what is up in its picture.
Frame frame_of(const Described& scene, Up up) {
  Frame frame;
  if (!scene.cameras.empty()) {
    const Affine& camera = scene.cameras.front().to_world;
    frame.mirrored = camera.mirrors();
    if (up == Up::by_camera) {
      const Vec3d& y = camera.y;
      const double x = std::abs(y.x), z = std::abs(y.z), upright = std::abs(y.y);
      up = upright >= x && upright >= z ? Up::y : z >= x ? Up::z : Up::x;
      frame.downwards = (up == Up::y ? y.y : up == Up::z ? y.z : y.x) < 0;
    }
  }
  if (up == Up::by_camera) up = Up::y;
  frame.up = up;
  // Rotations that take the axis to +y and keep one of the others.
  Affine turn;
  if (up == Up::z) turn = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}};
  if (up == Up::x) turn = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {}};
  if (frame.downwards) turn = Affine{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}} * turn;
  if (frame.mirrored) turn = turn * Affine{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
  frame.to_gltf = turn;
  return frame;
}

constexpr double kShear = 1e-5;  // cosine between axes that still counts as a right angle

GltfJson three(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

// Of a rotation: x, y, z, w, of length 1.
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

// Translation, rotation and scale; false: the map shears or flattens.
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

Vec3d to_double(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
Vec3f to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// The mesh itself placed, for maps that a node cannot have.
Mesh baked(const Mesh& mesh, const Affine& m) {
  Mesh out = mesh;
  for (Vec3f& p : out.positions) p = to_float(m.point(to_double(p)));
  const double sign = m.mirrors() ? -1 : 1;
  const Affine normals{cross(m.y, m.z) * sign, cross(m.z, m.x) * sign, cross(m.x, m.y) * sign, {}};
  for (Vec3f& n : out.normals) n = to_float(normals.vector(to_double(n)));
  if (m.mirrors())
    for (auto& t : out.triangles) std::swap(t[1], t[2]);
  return out;
}

// Of length 1; where the file has none, those of the triangles.
std::vector<Vec3f> unit_normals(const Mesh& mesh) {
  std::vector<Vec3f> out;
  std::vector<Vec3d> of_triangles;
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    const Vec3d n = to_double(mesh.normals[i]);
    const double l = length(n);
    if (l > 1e-30 && std::isfinite(l)) {
      out.push_back(to_float(n / l));
      continue;
    }
    if (of_triangles.empty()) {
      of_triangles.resize(mesh.positions.size());
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d pa = to_double(mesh.positions[a]);
        const Vec3d across =
            cross(to_double(mesh.positions[b]) - pa, to_double(mesh.positions[c]) - pa);
        for (const uint32_t k : {a, b, c}) of_triangles[k] = of_triangles[k] + across;
      }
    }
    const double s = length(of_triangles[i]);
    out.push_back(s > 0 ? to_float(of_triangles[i] / s) : Vec3f(0, 0, 1));
  }
  return out;
}

class Writer {
 public:
  Writer(const Described& scene, const Writing& how, Source& source)
      : scene_(scene),
        how_(how),
        source_(source),
        surfaces_(scene, glb_, source, how.longest_texture) {}

  Written write() {
    out_.frame = frame_of(scene_, how_.up);
    root_["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
    root_["asset"]["extras"]["source"] = how_.format;
    if (!how_.provenance.empty()) root_["asset"]["extras"]["provenance"] = how_.provenance.lines;
    root_["scene"] = 0;
    root_["scenes"] = GltfJson::array({GltfJson::object()});
    if (!scene_.title.empty()) root_["scenes"][0]["name"] = shown(scene_.title, 200);
    for (const Camera& c : scene_.cameras) add(c);
    for (const Lamp& l : scene_.lamps) add(l);
    for (const Shape& s : scene_.shapes) add(s);
    add_defaults();
    add_portals();
    std::set<std::string> used = surfaces_.extensions();
    if (has_lamps_) used.insert("KHR_lights_punctual");
    if (!used.empty()) root_["extensionsUsed"] = used;
    out_.materials = root_.contains("materials") ? root_["materials"].size() : 0;
    out_.textures = root_.contains("images") ? root_["images"].size() : 0;
    out_.glb = glb_.file();
    return std::move(out_);
  }

 private:
  void add(GltfJson node) {
    root_["nodes"].push_back(std::move(node));
    root_["scenes"][0]["nodes"].push_back(root_["nodes"].size() - 1);
  }
  void add(const Camera& camera);
  void add(const Lamp& lamp);
  void add(const Shape& shape);
  size_t mesh_of(const Shape& shape, const Mesh& mesh, bool shared);
  void add_defaults();
  void add_portals();

  void lose(const std::string& sentence) { source_.lose({source_.path(), ""}, sentence); }

  enum Attribute : size_t { kPosition, kNormal, kTexcoord, kIndex };
  const Described& scene_;
  const Writing& how_;
  Source& source_;
  Glb glb_;
  GltfJson& root_ = glb_.root;
  Surfaces surfaces_;
  Written out_;
  bool has_lamps_ = false;
  std::map<std::array<size_t, 3>, size_t> meshes_;     // mesh, material, turned
  std::map<std::array<size_t, 3>, size_t> accessors_;  // attribute, mesh, turned
};

void Writer::add(const Camera& camera) {
  const Affine m = out_.frame.to_gltf * camera.to_world;
  const double aspect = static_cast<double>(camera.width) / std::max(camera.height, 1);
  root_["cameras"].push_back(
      {{"name", shown(camera.name, 200)},
       {"type", "perspective"},
       {"perspective", {{"yfov", camera.yfov}, {"aspectRatio", aspect}, {"znear", 0.01}}}});
  if (camera.lens_radius > 0) {
    // As tdpt has it: a film 36 mm along its longer side.
    const double focal = 0.018 / (std::tan(camera.yfov / 2) * std::max(1.0, aspect));
    lose(fmt::format(
        "depth of field is no part of glTF: give --f-stop {:.4g} --focus {:.4g} to tdpt",
        focal / (2 * camera.lens_radius), camera.focus_distance));
  }
  if (camera.shift_x != 0 || camera.shift_y != 0) lose("the shift of the camera is left out");
  // Exactly at right angles: y is kept up in the picture.
  const Vec3d z = normalize(m.z), x = normalize(cross(m.y, z));
  GltfJson node = {{"name", shown(camera.name, 200)}, {"camera", root_["cameras"].size() - 1}};
  put_trs({x, cross(z, x), z, m.t}, node);
  add(std::move(node));
}

void Writer::add(const Lamp& lamp) {
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
  GltfJson& lights = root_["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(std::move(light));
  has_lamps_ = true;
  GltfJson node = {{"name", shown(lamp.name, 200)},
                   {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
  Affine m;
  if (lamp.kind != Lamp::Kind::point) {
    const Onb<double> frame(-normalize(out_.frame.to_gltf.vector(lamp.towards)));
    m = {frame.x, frame.y, frame.z, {}};
  }
  m.t = lamp.kind == Lamp::Kind::sun ? Vec3d(0) : out_.frame.to_gltf.point(lamp.at);
  put_trs(m, node);
  add(std::move(node));
}

size_t Writer::mesh_of(const Shape& shape, const Mesh& mesh, bool shared) {
  const Surfaces::Written surface = surfaces_.written(shape.material, shape.emission);
  const std::array<size_t, 3> key{shape.mesh, surface.index, shape.turned};
  if (const auto it = meshes_.find(key); shared && it != meshes_.end()) return it->second;
  const auto accessor = [&](Attribute attribute, bool turned, const auto& make) {
    if (!shared) return make();
    const std::array<size_t, 3> of{attribute, shape.mesh, turned};
    const auto it = accessors_.find(of);
    return it != accessors_.end() ? it->second : accessors_[of] = make();
  };
  GltfJson primitive;
  GltfJson& attributes = primitive["attributes"];
  attributes["POSITION"] =
      accessor(kPosition, false, [&] { return glb_.positions(mesh.positions); });
  if (mesh.normals.size() == mesh.positions.size())
    attributes["NORMAL"] = accessor(kNormal, shape.turned, [&] {
      std::vector<Vec3f> normals = unit_normals(mesh);
      if (shape.turned)
        for (Vec3f& n : normals) n = -n;
      return glb_.normals(normals);
    });
  if (surface.textured && mesh.uv.size() == mesh.positions.size())
    attributes["TEXCOORD_0"] = accessor(kTexcoord, false, [&] { return glb_.uv(mesh.uv); });
  primitive["indices"] = accessor(kIndex, shape.turned, [&] {
    auto triangles = mesh.triangles;
    if (shape.turned)
      for (auto& t : triangles) std::swap(t[1], t[2]);
    return glb_.indices(triangles, mesh.positions.size());
  });
  primitive["material"] = surface.index;
  GltfJson out;
  if (!shape.name.empty()) out["name"] = shown(shape.name, 200);
  out["primitives"] = GltfJson::array({std::move(primitive)});
  root_["meshes"].push_back(std::move(out));
  const size_t at = root_["meshes"].size() - 1;
  if (shared) meshes_[key] = at;
  return at;
}

void Writer::add(const Shape& shape) {
  if (scene_.materials[shape.material].invisible && !shape.emission) return;
  const Mesh& mesh = scene_.meshes[shape.mesh];
  if (mesh.triangles.empty()) return;
  const Affine m = out_.frame.to_gltf * shape.to_world;
  GltfJson node;
  if (!shape.name.empty()) node["name"] = shown(shape.name, 200);
  GltfJson placed = node;
  if (put_trs(m, placed)) {
    placed["mesh"] = mesh_of(shape, mesh, true);
    add(std::move(placed));
  } else {
    node["mesh"] = mesh_of(shape, baked(mesh, m), false);
    add(std::move(node));
  }
  ++out_.shapes;
  out_.triangles += mesh.triangles.size();
  if (shape.emission) out_.emitters += mesh.triangles.size();
}

void Writer::add_defaults() {
  GltfJson extras = GltfJson::object();
  if (!scene_.cameras.empty() && scene_.cameras.front().width > 0) {
    extras["tdpt_width"] = scene_.cameras.front().width;
    extras["tdpt_height"] = scene_.cameras.front().height;
  }
  WrittenSky sky = written_sky(scene_, out_.frame, source_);
  if (!sky.bytes.empty()) extras["tdpt_environment"] = how_.environment + sky.suffix;
  extras.update(sky.extras);
  out_.environment = std::move(sky.bytes);
  out_.environment_suffix = sky.suffix;
  if (!extras.empty()) root_["scenes"][0]["extras"] = std::move(extras);
}

// Fronts face the first camera. Where the source says otherwise, light may pass both ways.
void Writer::add_portals() {
  PortalFile file;
  file.provenance = how_.provenance;
  for (const Shape& shape : scene_.portals) {
    const Mesh mesh = baked(scene_.meshes[shape.mesh], out_.frame.to_gltf * shape.to_world);
    Portal portal;
    for (const Vec3f& p : mesh.positions) {
      if (!(length(to_double(p)) < 1e30))
        throw InputError(source_.path(), "", "has a portal that is too large or too far away");
      portal.vertices.push_back(to_double(p));
    }
    for (const auto& t : mesh.triangles) {
      const Vec3d& at = portal.vertices[t[0]];
      if (length(cross(portal.vertices[t[1]] - at, portal.vertices[t[2]] - at)) > 0)
        portal.triangles.push_back(t);
    }
    if (portal.triangles.empty()) {
      lose("a portal without an area is left out");
      continue;
    }
    double towards_camera = shape.turned ? -1 : 1;
    if (!scene_.cameras.empty()) {
      const Vec3d eye = out_.frame.to_gltf.point(scene_.cameras.front().to_world.t);
      double sum = 0;
      for (const auto& [a, b, c] : portal.triangles) {
        const Vec3d at = portal.vertices[a];
        sum += dot(cross(portal.vertices[b] - at, portal.vertices[c] - at), eye - at);
      }
      portal.both_ways = sum * towards_camera < 0;
      towards_camera = sum;
    }
    if (towards_camera < 0)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
    file.portals.push_back(std::move(portal));
  }
  if (!file.portals.empty()) out_.portals = portal_bytes(file);
}

}  // namespace

Written written(const Described& scene, const Writing& writing, Source& source) {
  return Writer(scene, writing, source).write();
}

}  // namespace tdpt::foreign
