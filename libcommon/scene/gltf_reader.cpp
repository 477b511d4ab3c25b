// From a checked glTF file to a Scene: triangles of all placed meshes, cameras, lights, materials,
// and the canonical frame. Everything is double precision until canonical positions are rounded to
// float.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "libcommon/base/memory_limit.h"
#include "libcommon/scene/distinct_names.h"
#include "libcommon/scene/gltf_accessors.h"
#include "libcommon/scene/gltf_attributes.h"
#include "libcommon/scene/gltf_document.h"
#include "libcommon/scene/gltf_lights.h"
#include "libcommon/scene/gltf_materials.h"
#include "libcommon/scene/gltf_nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

using namespace gltf;

// Instances multiply what a file holds; beyond this no ray tracer here would build its hierarchy.
constexpr size_t kMostVertices = size_t{1} << 27, kMostTriangles = size_t{1} << 28;

constexpr double kShortest = 1e-30, kLongest = 1e30;  // of the scene [m]
constexpr double kCoarsest = 1e-4;  // rounding of vertices that nobody sees, in sizes of the scene

class SceneReader {
 public:
  SceneReader(const Document& document, Scene& scene)
      : d_(document),
        scene_(scene),
        attributes_(document, scene),
        file_materials_(d_.json.contains("materials") ? d_.json["materials"].size() : 0) {}

  void run() {
    const std::vector<PlacedNode> nodes = place_nodes(d_);
    const std::vector<bool> used = used_materials(nodes);
    uses_ = read_materials(d_, used, scene_);
    uses_.emplace_back();  // of surfaces without one
    make_room(nodes);
    for (const PlacedNode& n : nodes) {
      const tinygltf::Node& node = d_.model.nodes[n.node];
      if (node.mesh >= 0) add_mesh(n, static_cast<size_t>(node.mesh));
      if (node.camera >= 0) add_camera(n, static_cast<size_t>(node.camera));
      if (const auto light = read_light(d_, n)) scene_.lights.push_back(*light);
      if (node.skin >= 0) ++skins_;
    }
    if (scene_.triangles.empty()) d_.fail("", "has no triangles in its scene");
    attributes_.finish(world_.size());
    if (unnamed_material_) scene_.materials.emplace_back().name = "default";
    for (size_t i = 0; i < scene_.materials.size(); ++i)
      finish_material(uses_[i], scene_.materials[i]);
    if (std::none_of(uses_.begin(), uses_.end(), [](const auto& u) { return u.coloured; }))
      scene_.colours = {};
    bring_to_canonical();
    drop_flat_triangles();
    mark_smooth_triangles(scene_);
    scene_.needs = needs_of(scene_);
    warn();
  }

 private:
  /// Materials of the surfaces of all placed meshes.
  std::vector<bool> used_materials(const std::vector<PlacedNode>& nodes) const {
    std::vector<bool> used(file_materials_);
    for (const PlacedNode& n : nodes) {
      const int mesh = d_.model.nodes[n.node].mesh;
      if (mesh < 0) continue;
      for (const tinygltf::Primitive& p : d_.model.meshes[static_cast<size_t>(mesh)].primitives)
        if (p.mode >= TINYGLTF_MODE_TRIANGLES && p.material >= 0)
          used[static_cast<size_t>(p.material)] = true;
    }
    return used;
  }

  /// Makes room for all; refuses a scene whose instances would fill the memory, before any vertex
  /// is read.
  void make_room(const std::vector<PlacedNode>& nodes) {
    const size_t bytes = most_bytes(d_);
    // A count beyond the bytes there are is wrong; it is refused with its place when it is read.
    const auto count = [&](int accessor) {
      return std::min(d_.model.accessors[static_cast<size_t>(accessor)].count, bytes);
    };
    size_t vertices = 0, triangles = 0;
    for (const PlacedNode& n : nodes) {
      const int mesh = d_.model.nodes[n.node].mesh;
      if (mesh < 0) continue;
      std::set<AttributeSet> seen;
      for (const tinygltf::Primitive& p : d_.model.meshes[static_cast<size_t>(mesh)].primitives) {
        const auto position = p.attributes.find("POSITION");
        if (position == p.attributes.end()) continue;
        if (p.mode >= TINYGLTF_MODE_TRIANGLES &&
            seen.insert(choose_attributes(p, uses_[material_of(p)])).second)
          vertices += count(position->second);
        const size_t corners = count(p.indices >= 0 ? p.indices : position->second);
        triangles += p.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3 : corners;
      }
      if (vertices > kMostVertices || triangles > kMostTriangles)
        d_.fail(place("nodes", n.node),
                fmt::format("brings the scene to {} vertices and {} triangles, expected at most {} "
                            "and {}",
                            vertices, triangles, kMostVertices, kMostTriangles));
    }
    expect_memory(d_.file, "nodes",
                  fmt::format("{} vertices and {} triangles", vertices, triangles),
                  vertices * (sizeof(Vec3d) + sizeof(Vec3f)) + triangles * sizeof(Triangle));
    world_.reserve(vertices);
    scene_.triangles.reserve(triangles);
  }

  /// The corners of a primitive, three per triangle.
  std::vector<uint32_t> corners(const tinygltf::Primitive& p, size_t vertices,
                                const std::string& where) const {
    std::vector<uint32_t> list;
    if (p.indices >= 0) {
      list = read_indices(d_, static_cast<size_t>(p.indices), vertices);
    } else {
      list.resize(vertices);
      for (uint32_t i = 0; i < vertices; ++i) list[i] = i;
    }
    if (p.mode == TINYGLTF_MODE_TRIANGLES) {
      if (list.size() % 3 != 0)
        d_.fail(where,
                fmt::format("has {} corners of triangles, expected a multiple of 3", list.size()));
      return list;
    }
    if (list.size() < 3)
      d_.fail(where, fmt::format("has {} corners, a strip or fan has at least 3", list.size()));
    std::vector<uint32_t> out;
    out.reserve(3 * (list.size() - 2));
    for (size_t i = 0; i + 2 < list.size(); ++i) {
      // glTF 2.0, 3.7.2.1: every second triangle of a strip runs the other way round.
      if (p.mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        out.insert(out.end(), {list[i], list[i + 1 + i % 2], list[i + 2 - i % 2]});
      else
        out.insert(out.end(), {list[i + 1], list[i + 2], list[0]});
    }
    return out;
  }

  void add_mesh(const PlacedNode& n, size_t mesh) {
    const bool mirrored = n.to_world.mirrors();
    std::map<AttributeSet, uint32_t> first_of;  // primitives often share all their vertices
    const auto& primitives = d_.model.meshes[mesh].primitives;
    for (size_t k = 0; k < primitives.size(); ++k) {
      const tinygltf::Primitive& p = primitives[k];
      const std::string where = place("meshes", mesh) + "." + place("primitives", k);
      if (p.mode < TINYGLTF_MODE_TRIANGLES) {
        ++no_surfaces_;
        continue;
      }
      const auto position = p.attributes.find("POSITION");
      if (position == p.attributes.end()) d_.fail(where, "has no attribute POSITION");
      MaterialUse& use = uses_[material_of(p)];
      const AttributeSet set = choose_attributes(p, use);
      check_counts(d_, set, where);
      const auto [first, is_new] = first_of.try_emplace(set, static_cast<uint32_t>(world_.size()));
      if (is_new) {
        add_vertices(n, static_cast<size_t>(position->second));
        attributes_.add(set, n.to_world, first->second);
      }
      const size_t vertices = d_.model.accessors[static_cast<size_t>(position->second)].count;
      const std::vector<uint32_t> corner = corners(p, vertices, where);
      add_triangles(corner, first->second, mirrored, material_of(p));
      note_grain(n, static_cast<size_t>(position->second), corner, first->second);
      unnamed_material_ |= p.material < 0;
      attributes_.note_colours(set, use);
      for (size_t u = 0; u < 2; ++u)
        if (use.uv[u] && set.uv[u] < 0) without_uv_.insert({mesh, k});
      if (use.unlit && p.attributes.contains("COLOR_0")) coloured_.insert({mesh, k});
      if (!p.targets.empty()) morphed_.insert({mesh, k});
    }
  }

  size_t material_of(const tinygltf::Primitive& p) const {
    return p.material < 0 ? file_materials_ : static_cast<size_t>(p.material);
  }

  void add_vertices(const PlacedNode& n, size_t accessor) {
    for (const Vec3d& p : read_positions(d_, accessor)) {
      world_.push_back(n.to_world.point(p));
      if (!is_finite(world_.back()))
        d_.fail(place("nodes", n.node), "its transform takes a vertex beyond double precision");
    }
  }

  /// What rounding has made of these vertices: of floats in the file, and of doubles in the world.
  void note_grain(const PlacedNode& n, size_t accessor, const std::vector<uint32_t>& corner,
                  uint32_t first) {
    const bool floats = d_.model.accessors[accessor].componentType == TINYGLTF_COMPONENT_TYPE_FLOAT;
    const Vec3d& moved = n.to_world.t;
    double reach = 0;  // of the vertices before the node moves them
    for (const uint32_t c : corner) reach = std::max(reach, length(world_[first + c] - moved));
    grain_ = std::max(grain_, (floats ? 0x1p-24 : 0) * reach + 0x1p-53 * (length(moved) + reach));
  }

  void add_triangles(const std::vector<uint32_t>& corner, uint32_t first, bool mirrored,
                     size_t material) {
    const auto m = static_cast<uint32_t>(material);
    for (size_t i = 0; i + 2 < corner.size(); i += 3) {
      Triangle t{{first + corner[i], first + corner[i + 1], first + corner[i + 2]}, m};
      if (mirrored) std::swap(t.vertex[1], t.vertex[2]);  // the front stays the front
      scene_.triangles.push_back(t);
    }
  }

  void add_camera(const PlacedNode& n, size_t index) {
    const tinygltf::Camera& c = d_.model.cameras[index];
    if (c.type != "perspective") {
      ++orthographic_;
      return;
    }
    const Affine& a = n.to_world;
    Camera out;
    out.position = a.t;
    const auto direction = [&](const Vec3d& v) {
      const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
      const Vec3d scaled = v / largest;
      if (!(largest > 0) || !is_finite(scaled) || !(length(scaled) > 1e-9))
        d_.fail(place("nodes", n.node), "holds a camera, but its transform is flat");
      return normalize(scaled);
    };
    out.forward = direction(-a.z);
    out.right = direction(cross(out.forward, direction(a.y)));
    out.up = cross(out.right, out.forward);
    out.yfov = c.perspective.yfov;
    out.aspect = c.perspective.aspectRatio;
    out.name = camera_names_.take(c.name, d_.model.nodes[n.node].name, "camera");
    scene_.cameras.push_back(out);
  }

  void bring_to_canonical() {
    Vec3d low(std::numeric_limits<double>::infinity()), high = -low;
    for (const Triangle& t : scene_.triangles)
      for (uint32_t v : t.vertex) low = min(low, world_[v]), high = max(high, world_[v]);
    const double longest = max_component(high - low);
    if (longest == 0) d_.fail("", "has no triangle with an area");
    if (!(longest >= kShortest && longest <= kLongest))
      d_.fail("", fmt::format("is {} m long, expected {} to {}", longest, kShortest, kLongest));
    if (grain_ > kCoarsest * longest)
      scene_.warnings.push_back(
          fmt::format("the scene lies so far from the origin that its vertices are known to {:.1g} "
                      "m only, {:.1g} of its size",
                      grain_, grain_ / longest));
    int exponent = 0;
    const double mantissa = std::frexp(longest, &exponent);  // in [0.5, 1)
    scene_.frame.scale = std::ldexp(1.0, (mantissa == 0.5 ? 2 : 1) - exponent);
    scene_.frame.centre = low * 0.5 + high * 0.5;
    scene_.positions.reserve(world_.size() + 1);  // so that a Tracer needs no copy
    for (const Vec3d& p : world_) scene_.positions.push_back(rounded(scene_.frame.to_canonical(p)));
    world_ = {};
    for (Camera& c : scene_.cameras) c.position = scene_.frame.to_canonical(c.position);
    for (PunctualLight& l : scene_.lights) to_canonical(d_, scene_.frame, l);
    for (Material& m : scene_.materials)  // per metre -> per canonical length
      m.absorption = Rgb(min(Vec3d(m.absorption) / scene_.frame.scale, Vec3d(1e30)));
  }

  /// Vertices of no triangle may lie anywhere, also where float does not reach.
  static Vec3f rounded(const Vec3d& p) {
    const Vec3d limit(4.0);
    return Vec3f(max(min(p, limit), -limit));
  }

  void drop_flat_triangles() {
    dropped_ = std::erase_if(scene_.triangles, [&](const Triangle& t) {
      const Vec3d p(scene_.positions[t.vertex[0]]);
      const Vec3d n =
          cross(Vec3d(scene_.positions[t.vertex[1]]) - p, Vec3d(scene_.positions[t.vertex[2]]) - p);
      return !(length(n) > 0);
    });
    if (scene_.triangles.empty()) d_.fail("", "has no triangle with an area");
  }

  void warn() {
    const auto tell = [&](size_t n, const char* noun, const char* one, const char* many) {
      if (n > 0) scene_.warnings.push_back(counted(n, noun, one, many));
    };
    if (unnamed_material_)
      scene_.warnings.push_back("surfaces without a material are taken as diffuse grey of 0.8");
    tell(dropped_, "triangle", "without area is left out", "without area are left out");
    tell(no_surfaces_, "set", "of points or lines is left out", "of points or lines are left out");
    tell(orthographic_, "orthographic camera", "is left out", "are left out");
    tell(without_uv_.size(), "primitive",
         "lacks the texture coordinates that its material asks for: taken as 0",
         "lack the texture coordinates that their materials ask for: taken as 0");
    tell(coloured_.size(), "unlit primitive", "has vertex colours, which are left out",
         "have vertex colours, which are left out");
    tell(skins_, "skinned mesh", "is taken in its rest pose", "are taken in their rest pose");
    tell(morphed_.size(), "primitive", "has morph targets, which are left out",
         "have morph targets, which are left out");
    if (d_.json.contains("animations")) scene_.warnings.push_back("animations are left out");
    if (uses_extension(d_, "EXT_mesh_gpu_instancing"))
      scene_.warnings.push_back("instances by EXT_mesh_gpu_instancing are left out");
  }

  const Document& d_;
  Scene& scene_;
  std::vector<Vec3d> world_;  // metres, parallel to scene_.positions; none any more once these are
  AttributeReader attributes_;
  DistinctNames camera_names_;
  size_t file_materials_;          // the surfaces without a material come behind them
  std::vector<MaterialUse> uses_;  // by material
  bool unnamed_material_ = false;
  double grain_ = 0;  // largest rounding of a vertex [m]
  size_t dropped_ = 0, no_surfaces_ = 0, orthographic_ = 0, skins_ = 0;
  std::set<std::pair<size_t, size_t>> without_uv_, coloured_, morphed_;  // mesh, primitive
};

}  // namespace

Scene read_gltf(const std::string& path) {
  Document document;
  open_document(path, document);
  Scene scene;
  scene.path = path;
  scene.hash = document.hash;
  scene.files = document.files;
  SceneReader(document, scene).run();
  return scene;
}

}  // namespace tdpt
