#include "libcommon/scene/gltf/nodes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {

namespace {

constexpr const char* kInstances = "EXT_mesh_gpu_instancing";
constexpr const char* kAttributes[] = {"TRANSLATION", "ROTATION", "SCALE"};

/// The index of a light in the list of an extension, kNone if the node has none.
size_t read_light(const Value& node, const char* extension) {
  const Value light = node.extension(extension);
  if (!light) return kNone;
  return light["light"].needed().index_below(node.root().extension(extension)["lights"].size(),
                                             "lights");
}

Affine from_matrix(const Document& d, size_t index, const std::vector<double>& m) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6; };
  if (!near(m[3], 0) || !near(m[7], 0) || !near(m[11], 0) || !near(m[15], 1))
    d.fail(place("nodes", index) + ".matrix", "is not affine, expected a last row of 0 0 0 1");
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

/// The given nodes and all below them.
std::vector<bool> reached_from(const Document& d, std::vector<size_t> next) {
  std::vector<bool> reached(d.nodes.size());
  while (!next.empty()) {
    const size_t n = next.back();
    next.pop_back();
    if (reached[n]) continue;
    reached[n] = true;
    next.insert(next.end(), d.nodes[n].children.begin(), d.nodes[n].children.end());
  }
  return reached;
}

/// Parents of all nodes; kNone for roots.
std::vector<size_t> parents_of(const Document& d) {
  std::vector<size_t> parent(d.nodes.size(), kNone);
  for (size_t i = 0; i < parent.size(); ++i)
    for (const size_t child : d.nodes[i].children) {
      size_t& p = parent[child];
      if (p != kNone)
        d.fail(place("nodes", child),
               fmt::format("is reached twice, from nodes[{}] and nodes[{}]", p, i));
      p = i;
    }
  return parent;
}

/// The parent's map times the node's own.
Affine map_below(const Document& d, const Affine& parent, size_t node) {
  const Affine a = parent * local_map(d, node);
  if (!is_finite(a.x) || !is_finite(a.y) || !is_finite(a.z) || !is_finite(a.t))
    d.fail(place("nodes", node), "its transform and those above it exceed double precision");
  return a;
}

}  // namespace

Lens read_lens(const Value& camera) {
  Lens out;
  out.name = camera["name"].text();
  out.perspective = camera["type"].needed().one_of({"perspective", "orthographic"}, 0) == 0;
  if (!out.perspective) return out;
  const Value lens = camera["perspective"].needed(), yfov = lens["yfov"].needed(),
              aspect = lens["aspectRatio"];
  out.yfov = yfov.number(0);
  if (!(out.yfov > 0 && out.yfov < std::numbers::pi)) yfov.fail("an angle between 0 and pi");
  if (aspect) out.aspect = aspect.number_above_0(0);
  return out;
}

Node read_node(const Value& v) {
  Node out;
  out.name = v["name"].text();
  out.children = v["children"].indices("nodes");
  out.camera = v["camera"].index("cameras");
  out.mesh = v["mesh"].index("meshes");
  out.skin = v["skin"].index("skins");
  out.matrix = v["matrix"].numbers(16);
  out.translation = v["translation"].triple(out.translation);
  out.scale = v["scale"].triple(out.scale);
  if (const std::vector<double> r = v["rotation"].numbers(4); !r.empty())
    out.rotation = {r[0], r[1], r[2], r[3]};
  out.weights = v["weights"].numbers(0);
  out.hidden = !v.extension("KHR_node_visibility")["visible"].boolean(true);
  out.lamp = read_light(v, "KHR_lights_punctual");
  out.area_light = read_light(v, "EXT_lights_area");
  out.luminaire.light = read_light(v, "EXT_lights_ies");
  const Value luminaire = v.extension("EXT_lights_ies");
  out.luminaire.multiplier = luminaire["multiplier"].number(1, 0);
  out.luminaire.colour = luminaire["color"].triple(Vec3d(1), 0);
  if (const Value instances = v.extension(kInstances)) {
    const Value attributes = instances["attributes"].needed();
    for (size_t k = 0; k < 3; ++k) out.instances[k] = attributes[kAttributes[k]].index("accessors");
  }
  return out;
}

Skin read_skin(const Value& v) {
  Skin out{v["joints"].indices("nodes"), v["inverseBindMatrices"].index("accessors")};
  if (out.joints.empty())
    v["joints"].fail_because("is missing or empty, expected at least one joint");
  return out;
}

std::vector<size_t> read_roots(const Document& d) {
  std::vector<bool> seen(d.nodes.size());
  std::vector<size_t> out;
  const std::vector<Value> scenes = d.root()["scenes"].items();
  const size_t named = d.root()["scene"].index("scenes"), shown = named == kNone ? 0 : named;
  for (size_t i = 0; i < scenes.size(); ++i)
    for (const size_t node : scenes[i]["nodes"].indices("nodes")) {
      if (i != shown) continue;
      if (!seen[node]) out.push_back(node);
      seen[node] = true;
    }
  if (!scenes.empty()) return out;
  for (const Node& n : d.nodes)
    for (const size_t child : n.children) seen[child] = true;
  for (size_t i = 0; i < seen.size(); ++i)
    if (!seen[i]) out.push_back(i);
  return out;
}

Vec3d direction_of(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest > 0 && is_finite(v) ? normalize(v / largest) : Vec3d();
}

Affine local_map(const Document& d, size_t index) {
  const Node& n = d.nodes[index];
  if (!n.matrix.empty()) return from_matrix(d, index, n.matrix);
  const auto map = affine_of(n.translation, n.rotation, n.scale);
  if (!map) d.fail(place("nodes", index) + ".rotation", "is zero, expected a unit quaternion");
  return *map;
}

PlacedNodes place_nodes(const Document& d) {
  const std::vector<bool> reached = reached_from(d, d.roots);
  const std::vector<size_t> parent = parents_of(d);
  PlacedNodes out;
  out.to_world.resize(parent.size());
  std::vector<PlacedNode> stack;  // with the parent's map; explicit, since depth is unbounded
  for (size_t i = 0; i < parent.size(); ++i)
    if (parent[i] == kNone && !reached[i]) stack.push_back({i, {}, true});
  for (size_t i = d.roots.size(); i-- > 0;)
    if (parent[d.roots[i]] == kNone) stack.push_back({d.roots[i], {}, true});
  std::vector<bool> placed(parent.size());
  while (!stack.empty()) {
    PlacedNode n = std::move(stack.back());
    stack.pop_back();
    n.to_world = map_below(d, n.to_world, n.node);
    n.visible = n.visible && !d.nodes[n.node].hidden;
    placed[n.node] = true;
    out.to_world[n.node] = n.to_world;
    const auto& below = d.nodes[n.node].children;
    for (size_t i = below.size(); i-- > 0;) stack.push_back({below[i], n.to_world, n.visible});
    if (reached[n.node]) out.of_scene.push_back(std::move(n));
  }
  for (size_t i = 0; i < placed.size(); ++i)
    if (!placed[i]) d.fail(place("nodes", i), "is its own ancestor, expected a tree of nodes");
  return out;
}

namespace {

size_t count_of(const Document& d, size_t accessor) {
  return d.accessors[accessor].count;
}

}  // namespace

size_t instances_declared(const Document& d, size_t node) {
  const std::array<size_t, 3>& all = d.nodes[node].instances;
  const auto first = std::find_if(all.begin(), all.end(), [](size_t a) { return a != kNone; });
  if (first == all.end()) return 1;
  const size_t count = count_of(d, *first);
  for (size_t k = 0; k < 3; ++k)
    if (all[k] != kNone && count_of(d, all[k]) != count)
      d.fail(fmt::format("nodes[{}].extensions.{}.attributes.{}", node, kInstances, kAttributes[k]),
             fmt::format("count is {}, expected {} as of {}", count_of(d, all[k]), count,
                         kAttributes[first - all.begin()]));
  return count;
}

std::vector<Affine> place_instances(const Document& d, const PlacedNode& n) {
  const size_t count = instances_declared(d, n.node);
  const std::array<size_t, 3>& accessors = d.nodes[n.node].instances;
  const auto read = [&](size_t k, const Numbers& numbers) {
    return accessors[k] == kNone ? std::vector<double>{} : read_numbers(d, accessors[k], numbers);
  };
  const std::vector<double> t = read(0, kTranslations), r = read(1, kRotations),
                            s = read(2, kScales);
  std::vector<Affine> out;
  out.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const auto vec = [&](const std::vector<double>& v, double otherwise) {
      return v.empty() ? Vec3d(otherwise) : Vec3d(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    };
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!r.empty()) rotation = {r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]};
    const auto map = affine_of(vec(t, 0), rotation, vec(s, 1));
    if (!map)
      d.fail(place("accessors", accessors[1]),
             fmt::format("rotation {} is zero, expected a unit quaternion", i));
    out.push_back(n.to_world * *map);
  }
  return out;
}

namespace {

constexpr Numbers kMatrices = {"inverse bind matrices", 16};
constexpr Numbers kJoints = {"joints", 4, Numbers::Kind::indices};
constexpr Numbers kJointWeights = {"weights", 4, Numbers::Kind::shares};

void add_scaled(Affine& sum, const Affine& a, double weight) {
  sum.x += a.x * weight;
  sum.y += a.y * weight;
  sum.z += a.z * weight;
  sum.t += a.t * weight;
}

}  // namespace

std::vector<JointSet> joint_sets_of(const Primitive& p) {
  std::vector<JointSet> out;
  for (size_t k = 0;; ++k) {
    const size_t joints = find_attribute(p.attributes, fmt::format("JOINTS_{}", k));
    const size_t weights = find_attribute(p.attributes, fmt::format("WEIGHTS_{}", k));
    if (joints == kNone || weights == kNone) return out;
    out.push_back({joints, weights});
  }
}

std::vector<Affine> joint_maps(const Document& d, size_t skin, const PlacedNodes& nodes) {
  const Skin& s = d.skins[skin];
  const size_t count = s.joints.size();
  std::vector<double> m;
  if (s.matrices != kNone) m = read_numbers(d, s.matrices, kMatrices, 0, count);
  std::vector<Affine> out;
  for (size_t k = 0; k < count; ++k) {
    out.push_back(nodes.to_world[s.joints[k]]);
    if (m.empty()) continue;
    const auto column = [&](size_t c) {
      return Vec3d(m[16 * k + 4 * c], m[16 * k + 4 * c + 1], m[16 * k + 4 * c + 2]);
    };
    out.back() = out.back() * Affine{column(0), column(1), column(2), column(3)};
  }
  return out;
}

std::vector<Affine> blend_joints(const Document& d, const std::vector<Affine>& joints,
                                 const std::vector<JointSet>& sets, size_t vertices) {
  std::vector<Affine> out(vertices, {{}, {}, {}, {}});
  std::vector<double> total(vertices), lone;  // lone: the first joint of each vertex
  for (const JointSet& set : sets) {
    const std::vector<double> joint = read_numbers(d, set.joints, kJoints, 0, vertices);
    const std::vector<double> weight = read_numbers(d, set.weights, kJointWeights, 0, vertices);
    if (lone.empty())
      for (size_t v = 0; v < vertices; ++v) lone.push_back(joint[4 * v]);
    for (size_t i = 0; i < joint.size(); ++i) {
      if (weight[i] == 0) continue;
      const auto k = static_cast<size_t>(joint[i]);
      if (k >= joints.size())
        d.fail(place("accessors", set.joints),
               fmt::format("joint {} of vertex {} is out of range, the skin has {} joints", k,
                           i / 4, joints.size()));
      add_scaled(out[i / 4], joints[k], weight[i]);
      total[i / 4] += weight[i];
    }
  }
  for (size_t v = 0; v < out.size(); ++v) {
    if (total[v] > 0) {
      const double scale = 1 / total[v];
      Affine& a = out[v];
      a = {a.x * scale, a.y * scale, a.z * scale, a.t * scale};
    } else {
      out[v] =
          joints[lone[v] < static_cast<double>(joints.size()) ? static_cast<size_t>(lone[v]) : 0];
    }
  }
  return out;
}

}  // namespace tdpt::gltf
