#include "tools/tdpt-import/gltf/writer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/formats/portal.h"
#include "tdpt_version.h"
#include "tools/tdpt-import/gltf/buffer.h"
#include "tools/tdpt-import/gltf/sky.h"
#include "tools/tdpt-import/gltf/surfaces.h"

namespace tdpt::foreign {
namespace {

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

Vec3d of(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
Vec3f to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// The mesh itself placed, for maps that a node cannot have.
Mesh baked(const Mesh& mesh, const Affine& m) {
  Mesh out = mesh;
  for (Vec3f& p : out.positions) p = to_float(m.point(of(p)));
  const double sign = m.mirrors() ? -1 : 1;
  const Affine normals{cross(m.y, m.z) * sign, cross(m.z, m.x) * sign, cross(m.x, m.y) * sign, {}};
  for (Vec3f& n : out.normals) n = to_float(normals.vector(of(n)));
  if (m.mirrors())
    for (auto& t : out.triangles) std::swap(t[1], t[2]);
  return out;
}

// Of length 1; where the file has none, those of the triangles.
std::vector<Vec3f> unit_normals(const Mesh& mesh) {
  std::vector<Vec3f> out;
  std::vector<Vec3d> of_triangles;
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    const Vec3d n = of(mesh.normals[i]);
    const double l = length(n);
    if (l > 1e-30 && std::isfinite(l)) {
      out.push_back(to_float(n / l));
      continue;
    }
    if (of_triangles.empty()) {
      of_triangles.resize(mesh.positions.size());
      for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d pa = of(mesh.positions[a]);
        const Vec3d across = cross(of(mesh.positions[b]) - pa, of(mesh.positions[c]) - pa);
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
        buffer_(root_),
        textures_(scene, root_, buffer_, source, how.longest_texture),
        surfaces_(scene, root_, textures_, source) {}

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
    put_extensions();
    out_.materials = root_.contains("materials") ? root_["materials"].size() : 0;
    out_.textures = root_.contains("images") ? root_["images"].size() : 0;
    out_.glb = buffer_.glb();
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
  GltfJson attributes_of(const Mesh& mesh, size_t index, bool turned, bool textured, bool shared);
  void add_defaults();
  void add_portals();
  void put_extensions();

  const Described& scene_;
  const Writing& how_;
  Source& source_;
  GltfJson root_;
  Buffer buffer_;
  Textures textures_;
  Surfaces surfaces_;
  Written out_;
  bool has_lamps_ = false;
  std::map<std::array<size_t, 3>, size_t> meshes_;             // mesh, material, turned
  std::map<std::array<size_t, 2>, size_t> normals_, indices_;  // mesh, turned
  std::map<size_t, size_t> positions_, uv_;                    // mesh
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
    source_.lose(
        {source_.path(), ""},
        fmt::format(
            "depth of field is no part of glTF: give --f-stop {:.4g} --focus {:.4g} to tdpt",
            focal / (2 * camera.lens_radius), camera.focus_distance));
  }
  if (camera.shift_x != 0 || camera.shift_y != 0)
    source_.lose({source_.path(), ""}, "the shift of the camera is left out");
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

GltfJson Writer::attributes_of(const Mesh& mesh, size_t index, bool turned, bool textured,
                               bool shared) {
  const auto once = [&](auto& cache, const auto& key, const auto& make) {
    if (!shared) return make();
    const auto it = cache.find(key);
    return it != cache.end() ? it->second : cache.emplace(key, make()).first->second;
  };
  GltfJson a;
  a["POSITION"] = once(positions_, index, [&] { return buffer_.positions(mesh.positions); });
  if (mesh.normals.size() == mesh.positions.size())
    a["NORMAL"] = once(normals_, std::array<size_t, 2>{index, turned}, [&] {
      std::vector<Vec3f> normals = unit_normals(mesh);
      if (turned)
        for (Vec3f& n : normals) n = -n;
      return buffer_.normals(normals);
    });
  if (textured && mesh.uv.size() == mesh.positions.size())
    a["TEXCOORD_0"] = once(uv_, index, [&] { return buffer_.uv(mesh.uv); });
  return a;
}

size_t Writer::mesh_of(const Shape& shape, const Mesh& mesh, bool shared) {
  const Surfaces::Written surface = surfaces_.of(shape.material, shape.emission);
  const std::array<size_t, 3> key{shape.mesh, surface.index, shape.turned};
  if (const auto it = meshes_.find(key); shared && it != meshes_.end()) return it->second;
  GltfJson primitive;
  primitive["attributes"] = attributes_of(mesh, shape.mesh, shape.turned, surface.textured, shared);
  const auto write_indices = [&] {
    if (!shape.turned) return buffer_.indices(mesh.triangles, mesh.positions.size());
    auto triangles = mesh.triangles;
    for (auto& t : triangles) std::swap(t[1], t[2]);
    return buffer_.indices(triangles, mesh.positions.size());
  };
  const std::array<size_t, 2> indices{shape.mesh, shape.turned};
  if (!shared)
    primitive["indices"] = write_indices();
  else if (const auto it = indices_.find(indices); it != indices_.end())
    primitive["indices"] = it->second;
  else
    primitive["indices"] = indices_[indices] = write_indices();
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
      if (!(length(of(p)) < 1e30))
        throw InputError(source_.path(), "", "has a portal that is too large or too far away");
      portal.vertices.push_back(of(p));
    }
    for (const auto& t : mesh.triangles) {
      const Vec3d& at = portal.vertices[t[0]];
      if (length(cross(portal.vertices[t[1]] - at, portal.vertices[t[2]] - at)) > 0)
        portal.triangles.push_back(t);
    }
    if (portal.triangles.empty()) {
      source_.lose({source_.path(), ""}, "a portal without an area is left out");
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

void Writer::put_extensions() {
  std::set<std::string> used = surfaces_.extensions();
  if (has_lamps_) used.insert("KHR_lights_punctual");
  if (!used.empty()) root_["extensionsUsed"] = used;
}

}  // namespace

Written written(const Described& scene, const Writing& writing, Source& source) {
  return Writer(scene, writing, source).write();
}

}  // namespace tdpt::foreign
