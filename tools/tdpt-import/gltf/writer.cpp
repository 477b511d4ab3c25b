#include "tools/tdpt-import/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/portal.h"
#include "tdpt_version.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {

// ---- The binary part ----

namespace {

constexpr int kFloat = 5126, kShort = 5123, kInt = 5125, kVertices = 34962, kIndices = 34963;

// The index of an accessor of `count` elements.
template <class T>
size_t add_accessor(Glb& glb, const std::vector<T>& values, int component, size_t count,
                    const char* type) {
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                               values.size() * sizeof(T));
  const size_t view = glb.add(bytes, component == kFloat ? kVertices : kIndices);
  return glb.add(
      "accessors",
      {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

size_t add_positions(Glb& glb, const std::vector<Vec3f>& values) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  Vec3f low(std::numeric_limits<float>::infinity()), high = -low;
  for (const Vec3f& p : values) low = min(low, p), high = max(high, p);
  const size_t at = add_accessor(glb, values, kFloat, values.size(), "VEC3");
  glb.root["accessors"][at]["min"] = {low.x, low.y, low.z};
  glb.root["accessors"][at]["max"] = {high.x, high.y, high.z};
  return at;
}

template <class Index>
size_t add_indices(Glb& glb, const Mesh& mesh, bool turned, int component) {
  std::vector<Index> corners;
  for (auto [a, b, c] : mesh.triangles) {
    if (turned) std::swap(b, c);
    for (const uint32_t i : {a, b, c}) corners.push_back(static_cast<Index>(i));
  }
  return add_accessor(glb, corners, component, corners.size(), "SCALAR");
}

}  // namespace

size_t Glb::add(const char* section, GltfJson value) {
  root[section].push_back(std::move(value));
  return root[section].size() - 1;
}

size_t Glb::add(std::string_view bytes, int target) {
  GltfJson view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
  if (target) view["target"] = target;
  bin += bytes;
  bin.resize((bin.size() + 3) / 4 * 4);
  return add("bufferViews", std::move(view));
}

std::string Glb::file() {
  constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;
  if (!bin.empty()) root["buffers"] = GltfJson::array({{{"byteLength", bin.size()}}});
  std::string text = root.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const size_t total = 12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size());
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
  if (!bin.empty()) {
    word(bin.size()), word(kBinChunk);
    glb += bin;
  }
  return glb;
}

namespace {

// ---- The frame ----

// Mirrors the scene along x if its first camera is mirrored, and turns `up` to +y. By the camera:
// the axis that is nearest to what is up in its picture.
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
  // Rotations that take the axis to +y and keep one of the others.
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

// The mesh itself placed, for maps that a node cannot have.
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
    const size_t index = glb_.add("nodes", std::move(node));
    root_["scenes"][0]["nodes"].push_back(index);
  }
  void add(const Camera& camera);
  void add(const Lamp& lamp);
  void add(const Shape& shape);
  size_t mesh_of(const Shape& shape, const Mesh& mesh, size_t number);
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
  std::map<std::array<size_t, 3>, size_t> meshes_;     // by number, material, turned
  std::map<std::array<size_t, 3>, size_t> accessors_;  // by attribute, number, turned
};

void Writer::add(const Camera& camera) {
  const Affine m = out_.frame.to_gltf * camera.to_world;
  const double aspect = static_cast<double>(camera.width) / std::max(camera.height, 1);
  const size_t index = glb_.add(
      "cameras",
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
  GltfJson node = {{"name", shown(camera.name, 200)}, {"camera", index}};
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

// `number`: shapes with the same one have the same mesh.
size_t Writer::mesh_of(const Shape& shape, const Mesh& mesh, size_t number) {
  const Surfaces::Written surface = surfaces_.written(shape.material, shape.emission);
  const std::array<size_t, 3> key{number, surface.index, shape.turned};
  if (const auto it = meshes_.find(key); it != meshes_.end()) return it->second;
  const auto accessor = [&](Attribute attribute, bool turned, const auto& make) {
    const std::array<size_t, 3> of{attribute, number, turned};
    const auto it = accessors_.find(of);
    return it != accessors_.end() ? it->second : accessors_[of] = make();
  };
  GltfJson primitive;
  GltfJson& attributes = primitive["attributes"];
  attributes["POSITION"] =
      accessor(kPosition, false, [&] { return add_positions(glb_, mesh.positions); });
  if (mesh.normals.size() == mesh.positions.size())
    attributes["NORMAL"] = accessor(kNormal, shape.turned, [&] {
      Mesh checked = mesh;
      check(checked, source_.path());  // scales normals to length 1
      checked.normals.resize(mesh.positions.size(), {0, 0, 1});
      if (shape.turned)
        for (Vec3f& n : checked.normals) n = -n;
      return add_accessor(glb_, checked.normals, kFloat, checked.normals.size(), "VEC3");
    });
  if (surface.textured && mesh.uv.size() == mesh.positions.size())
    attributes["TEXCOORD_0"] = accessor(kTexcoord, false, [&] {
      return add_accessor(glb_, mesh.uv, kFloat, mesh.uv.size(), "VEC2");
    });
  primitive["indices"] = accessor(kIndex, shape.turned, [&] {
    return mesh.positions.size() > 65535 ? add_indices<uint32_t>(glb_, mesh, shape.turned, kInt)
                                         : add_indices<uint16_t>(glb_, mesh, shape.turned, kShort);
  });
  primitive["material"] = surface.index;
  GltfJson out;
  if (!shape.name.empty()) out["name"] = shown(shape.name, 200);
  out["primitives"] = GltfJson::array({std::move(primitive)});
  return meshes_[key] = glb_.add("meshes", std::move(out));
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
    placed["mesh"] = mesh_of(shape, mesh, shape.mesh);
    add(std::move(placed));
  } else {
    node["mesh"] = mesh_of(shape, baked(mesh, m), scene_.meshes.size() + out_.shapes);
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
  add_sky(scene_, source_, how_.environment, extras, out_);
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
      if (!(length(in_double(p)) < 1e30))
        throw InputError(source_.path(), "", "has a portal that is too large or too far away");
      portal.vertices.push_back(in_double(p));
    }
    for (const auto& t : mesh.triangles)
      if (length(front_of(mesh, t)) > 0) portal.triangles.push_back(t);
    if (portal.triangles.empty()) {
      lose("a portal without an area is left out");
      continue;
    }
    double towards_camera = shape.turned ? -1 : 1;
    if (!scene_.cameras.empty()) {
      const Vec3d eye = out_.frame.to_gltf.point(scene_.cameras.front().to_world.t);
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
  if (!file.portals.empty()) out_.portals = portal_bytes(file);
}

}  // namespace

Written written(const Described& scene, const Writing& writing, Source& source) {
  return Writer(scene, writing, source).write();
}

}  // namespace tdpt::foreign
