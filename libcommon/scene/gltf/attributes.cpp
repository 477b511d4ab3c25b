#include "libcommon/scene/gltf/parts.h"

#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"

namespace tdpt::gltf {

namespace {

// A triangle is flat if its normals are this close to the geometric one [rad].
constexpr double kFlat = 1e-3;

double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Inverse transpose of the linear part, up to a positive factor: the map for normals. The columns
/// may differ by any power of ten, so they are scaled first. All 0 for a flat map.
Affine normal_map_of(const Affine& a) {
  const Vec3d size{largest(a.x), largest(a.y), largest(a.z)};
  const double least = std::min({size.x, size.y, size.z});
  if (!(least > 0)) return {{}, {}, {}, {}};
  const Vec3d x = a.x / size.x, y = a.y / size.y, z = a.z / size.z;
  const double sign = a.mirrors() ? -1 : 1;
  return {cross(y, z) * (sign * (least / size.x)),
          cross(z, x) * (sign * (least / size.y)),
          cross(x, y) * (sign * (least / size.z)),
          {}};
}

constexpr std::array<float, 4> kWhite{1, 1, 1, 1};

/// A component of a vertex colour, made finite and not negative.
float within(float c) {
  return c > 0 ? std::min(c, 1e6f) : 0.0f;
}

// By AttributeKind.
const std::array<Numbers, kAttributes> kStored = {{
    {"positions", 3},
    {"normals", 3},
    {"tangents", 4},
    {"texture coordinates", 2},
    {"texture coordinates", 2},
    {"vertex colours", 4, Numbers::Kind::shares, 1},
}};
const std::array<Numbers, kAttributes> kDeltas = {{
    kStored[kPosition],
    kStored[kNormal],
    {"deltas of tangents", 3},
    {"deltas of texture coordinates", 2},
    {"deltas of texture coordinates", 2},
    {"deltas of vertex colours", 4, Numbers::Kind::shares, 0},
}};

Accessors find_attributes(const Attributes& attributes) {
  Accessors out;
  for (size_t k = 0; k < kAttributes; ++k) out[k] = find_attribute(attributes, kAttributeNames[k]);
  return out;
}

/// With the deltas of morph targets.
std::vector<float> read_attribute(const Document& d, const AttributeSet& set, AttributeKind kind) {
  const size_t vertices = d.accessors[set.accessors[kPosition]].count;
  std::vector<float> out = read_floats(d, set.accessors[kind], kStored[kind], vertices);
  const size_t components = kAttributeComponents[kind], n = kDeltas[kind].components;
  bool moved = false;
  for (const MorphTarget& t : set.targets) {
    if (t.accessors[kind] == kNone) continue;
    moved = true;
    const std::vector<float> delta = read_floats(d, t.accessors[kind], kDeltas[kind], vertices);
    for (size_t i = 0; i < delta.size(); ++i) {
      float& v = out[components * (i / n) + i % n];
      v = static_cast<float>(double{v} + t.weight * double{delta[i]});
    }
  }
  if (moved && kind == kColour)  // clamped, as the format prescribes
    for (float& c : out) c = c > 0 ? std::min(c, 1.0f) : 0.0f;
  return out;
}

void add_normals(const Document& d, const AttributeSet& set, const Placing& placing, Scene& scene) {
  const std::vector<float> v = read_attribute(d, set, kNormal);
  const Affine of_all = normal_map_of(placing.to_world);
  for (size_t i = 0; i < v.size(); i += 3) {
    const Vec3d n{v[i], v[i + 1], v[i + 2]};
    const bool alone = !placing.of_vertices.empty();
    const Vec3d to = alone ? normal_map_of(placing.of_vertices[i / 3]).vector(n) : of_all.vector(n);
    scene.normals.push_back(Vec3f(direction_of(to)));
  }
}

}  // namespace

AttributeSet choose_attributes(const Primitive& p, const MaterialUse& use,
                               const std::vector<double>& weights, bool skinned) {
  AttributeSet set;
  Accessors& a = set.accessors = find_attributes(p.attributes);
  if (!use.tangents || a[kNormal] == kNone) a[kTangent] = kNone;  // meaningless without normals
  for (size_t k = 0; k < 2; ++k)
    if (!use.uv[k]) a[kTexCoord0 + k] = kNone;
  if (!use.colours) a[kColour] = kNone;
  if (skinned) set.joints = joint_sets_of(p);
  for (size_t i = 0; i < std::min(p.targets.size(), weights.size()); ++i) {
    if (weights[i] == 0) continue;
    MorphTarget& t = set.targets.emplace_back();
    t = {weights[i], find_attributes(p.targets[i])};
    for (size_t k = 0; k < kAttributes; ++k)
      if (a[k] == kNone) t.accessors[k] = kNone;  // a delta of an absent attribute has no effect
  }
  return set;
}

void add_attributes(const Document& d, const AttributeSet& set, const Placing& placing,
                    size_t first, Scene& scene) {
  if (set.accessors[kNormal] != kNone) {
    scene.normals.resize(first, Vec3f{});
    add_normals(d, set, placing, scene);
  }
  if (set.accessors[kTangent] != kNone) {
    const std::vector<float> v = read_attribute(d, set, kTangent);
    const float mirrored = placing.mirrors ? -1 : 1;
    scene.tangents.resize(first, {0, 0, 0, 1});
    for (size_t i = 0; i < v.size(); i += 4) {
      const Vec3d t = direction_of(placing.map_of(i / 4).vector({v[i], v[i + 1], v[i + 2]}));
      const float hand = v[i + 3] < 0 ? -mirrored : mirrored;
      scene.tangents.push_back(
          {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z), hand});
    }
  }
  for (size_t k = 0; k < 2; ++k)
    if (const auto kind = static_cast<AttributeKind>(kTexCoord0 + k);
        set.accessors[kind] != kNone) {
      const std::vector<float> v = read_attribute(d, set, kind);
      scene.uv[k].resize(first, {0, 0});
      for (size_t i = 0; i < v.size(); i += 2) scene.uv[k].push_back({v[i], v[i + 1]});
    }
  if (set.accessors[kColour] != kNone) {
    const std::vector<float> v = read_attribute(d, set, kColour);
    scene.colours.resize(first, kWhite);
    for (size_t i = 0; i < v.size(); i += 4)
      scene.colours.push_back(
          {within(v[i]), within(v[i + 1]), within(v[i + 2]), std::min(within(v[i + 3]), 1.0f)});
  }
}

void note_colours(const Document& d, const AttributeSet& set, MaterialUse& use) {
  if (set.accessors[kColour] == kNone) return;
  const std::vector<float> v = read_attribute(d, set, kColour);
  for (size_t i = 0; i < v.size(); ++i) {
    if (i % 4 == 3 && !use.alpha) continue;
    use.coloured |= v[i] != 1;
    if (i % 4 == 3) use.least_vertex_alpha = std::min(use.least_vertex_alpha, within(v[i]));
  }
}

void fill_attributes(size_t vertices, Scene& scene) {
  if (!scene.normals.empty()) scene.normals.resize(vertices, Vec3f{});
  if (!scene.tangents.empty()) scene.tangents.resize(vertices, {0, 0, 0, 1});
  for (auto& uv : scene.uv)
    if (!uv.empty()) uv.resize(vertices, {0, 0});
  if (!scene.colours.empty()) scene.colours.resize(vertices, kWhite);
}

void mark_smooth_triangles(Scene& scene) {
  if (scene.normals.empty()) return;
  std::vector<uint8_t> smooth(scene.triangles.size());
  bool any = false;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    const Vec3d g = shape_of(scene, t).normal;
    double sum = 0, widest = 0;
    bool known = true;
    for (uint32_t v : scene.triangles[t].vertex) {
      const Vec3d n(scene.normals[v]);
      known &= n != Vec3d{};
      sum += dot(n, g);
    }
    if (!known) continue;
    const double side = sum < 0 ? -1 : 1;  // normals on the back are flipped
    for (uint32_t v : scene.triangles[t].vertex)
      widest = std::max(widest, length(Vec3d(scene.normals[v]) * side - g));
    if (widest <= kFlat) continue;
    smooth[t] = side < 0 ? 2 : 1;
    any = true;
  }
  if (any)
    scene.smooth = std::move(smooth);
  else
    scene.normals = {};
}

const std::vector<double>& morph_weights(const Document& d, size_t node) {
  const Node& n = d.nodes[node];
  if (!n.weights.empty() || n.mesh == kNone) return n.weights;
  return d.meshes[n.mesh].weights;
}

void add_position_deltas(const Document& d, const std::vector<MorphTarget>& targets,
                         std::vector<Vec3d>& positions) {
  for (const MorphTarget& t : targets) {
    const size_t accessor = t.accessors[kPosition];
    if (accessor == kNone) continue;
    const std::vector<Vec3d> deltas = read_positions(d, accessor, positions.size());
    for (size_t i = 0; i < deltas.size(); ++i) positions[i] += deltas[i] * t.weight;
  }
}

}  // namespace tdpt::gltf
