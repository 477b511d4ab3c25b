// Converts a checked glTF file to a Scene: triangles of all placed meshes, cameras, lights,
// materials, and the canonical frame. Everything is in double precision until canonical positions
// are rounded to float.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/defaults.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/gltf/parts.h"
#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

using namespace gltf;

constexpr double kShortest = 1e-30, kLongest = 1e30;  // size of the scene [m]
constexpr double kLargestReach = 1e9;                 // of its frame
constexpr double kCoarsest = 1e-4;  // largest invisible rounding of vertices / scene's size

/// Hash of where everything stands that light meets or comes from, of what moves at all: cameras
/// aside. Places of nodes, not of vertices: cheap in a scene of any size.
std::string hash_of_pose(const Document& d, const PlacedNodes& nodes) {
  std::string bytes;
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  std::set<size_t> skins;
  for (const PlacedNode& n : nodes.of_scene) {
    const Node& node = d.nodes[n.node];
    const bool counts = n.visible && (node.mesh != kNone || node.holds_light());
    if (!counts) continue;
    add(n.node), add(n.to_world), add(node.weights.size());
    for (const double w : node.weights) add(w);
    if (node.skin != kNone) skins.insert(node.skin);
  }
  for (const size_t skin : skins)
    for (const size_t joint : d.skins[skin].joints) add(nodes.to_world[joint]);
  return content_hash(bytes);
}

/// For a scene whose animations nobody asked about.
std::string beginning_sentence(const std::vector<AnimationFacts>& animations) {
  double last = 0;
  for (const AnimationFacts& a : animations) last = std::max(last, a.seconds);
  return fmt::format(
      "the scene stands as its animations begin; they last {} s: --at takes another "
      "time",
      number_words(last, 3));
}

/// Perspective cameras of nodes, still in metres, with distinct names.
std::vector<Camera> read_cameras(const Document& d, const PlacedNodes& nodes, Notes& notes) {
  std::vector<Camera> all;
  DistinctNames names;
  for (const PlacedNode& n : nodes.of_scene) {
    const Node& node = d.nodes[n.node];
    if (node.camera == kNone) continue;
    const Lens& lens = d.cameras[node.camera];
    if (!lens.perspective) {
      notes.add("orthographic cameras are left out", place("nodes", n.node));
      continue;
    }
    Camera out;
    // A flat camera takes a name, too: at another time it may not be flat.
    out.name = names.take(lens.name, node.name, "camera");
    out.position = n.to_world.t;
    out.forward = direction_of(-n.to_world.z);
    out.right = direction_of(cross(out.forward, direction_of(n.to_world.y)));
    if (out.right == Vec3d()) {
      notes.add("cameras with a flat transform are left out", place("nodes", n.node));
      continue;
    }
    out.up = cross(out.right, out.forward);
    out.yfov = lens.yfov;
    out.aspect = lens.aspect;
    all.push_back(out);
  }
  return all;
}

class SceneReader {
 public:
  SceneReader(const Document& document, Scene& scene)
      : d_(document), scene_(scene), notes_(document.notes) {}

  void run() {
    const PlacedNodes nodes = place_nodes(d_);
    if (scene_.moves) scene_.pose_hash = hash_of_pose(d_, nodes);
    std::vector<MaterialUse> uses = read_materials(d_, used_materials(d_, nodes), scene_, notes_);
    uses.emplace_back();  // default for surfaces without a material
    Meshes meshes = read_meshes(d_, nodes, scene_, uses, notes_);
    scene_.cameras = read_cameras(d_, nodes, notes_);
    if (meshes.unnamed_material) scene_.materials.emplace_back().name = "default";
    read_lights(d_, nodes, scene_, meshes.world, notes_);
    uses.resize(std::max(uses.size(), scene_.materials.size()));
    fill_attributes(meshes.world.size(), scene_);
    scene_.by_blender = is_blender(generator_of(d_));
    if (scene_.triangles.empty()) d_.fail("", "has no triangles in its scene");
    for (size_t i = 0; i < scene_.materials.size(); ++i)
      finish_material(uses[i], scene_.materials[i]);
    if (std::none_of(uses.begin(), uses.end(), [](const auto& u) { return u.coloured; }))
      scene_.colours = {};
    move_to_canonical(meshes.world, meshes.grain);
    drop_flat_triangles();
    mark_smooth_triangles(scene_);
    if (meshes.unnamed_material)
      scene_.warnings.push_back("surfaces without a material are taken as diffuse grey of 0.8");
    const std::vector<std::string> sentences = notes_.sentences();
    scene_.warnings.insert(scene_.warnings.end(), sentences.begin(), sentences.end());
  }

 private:
  struct Extent {
    Vec3d low = Vec3d(std::numeric_limits<double>::infinity()), high = -low;
    void add(const Vec3d& p) { low = min(low, p), high = max(high, p); }
    bool touches(const Extent& o) const {
      return max_component(low - o.high) <= 0 && max_component(o.low - high) <= 0;
    }
    Vec3d middle() const { return low * 0.5 + high * 0.5; }
    double longest() const { return max_component(high - low); }
  };

  // The extent that the frame is made for: of all triangles, unless others than those around the
  // cameras lie very much farther away. Floats are fine near the origin, so the room of the cameras
  // must be there, whatever stands at the horizon.
  Extent extent_of_frame(const std::vector<Vec3d>& world, const Extent& all) {
    // A box of 2^8 times the room's size costs it 8 of the 24 bits of floats.
    constexpr double kFarther = 256;
    Extent cameras;
    for (const Camera& c : scene_.cameras) cameras.add(c.position);
    const Vec3d middle = cameras.low.x <= cameras.high.x ? cameras.middle() : middle_of(world);
    std::vector<double> distances;
    for (const Triangle& t : scene_.triangles) distances.push_back(distance_of(t, world, middle));
    std::sort(distances.begin(), distances.end());
    const auto gap = [&](double least) {
      return std::adjacent_find(distances.begin(), distances.end(), [&](double near, double next) {
        return near >= least && next > kFarther * near;
      });
    };
    const double least = std::max(0.5 * cameras.longest(), std::numeric_limits<double>::min());
    const auto near = gap(least);
    if (near == distances.end()) return all;
    const auto far = gap(std::max(least, all.longest() / kLargestReach));
    Extent room;
    for (const Triangle& t : scene_.triangles)
      if (far != distances.end() && distance_of(t, world, middle) <= *far)
        for (uint32_t v : t.vertex) room.add(world[v]);
    if (!(room.longest() > all.longest() / kLargestReach)) {
      scene_.warnings.push_back(fmt::format(
          "a triangle {} m away is too far for what stands within {} m of the cameras: the picture "
          "is wrong or black; leave that triangle out",
          number_words(distances.back(), 2), number_words(*near, 2)));
      return all;
    }
    for (const Triangle& t : scene_.triangles) {
      Extent own;
      for (uint32_t v : t.vertex) own.add(world[v]);
      // Floats hold where a ray meets such a triangle only if it lies across an axis.
      const Vec3d d = own.high - own.low;
      if (std::min({d.x, d.y, d.z}) <= room.longest() || !own.touches(room)) continue;
      warn_of_slope(own.longest(), all.longest(), room.longest());
      return all;
    }
    return room;
  }
  // Ray origins are offset by 2^-21 in the frame [tracer.cpp], and pictures are wrong by about as
  // much of the room.
  void warn_of_slope(double size, double all, double room) {
    const double offset = std::exp2(std::floor(std::log2(all)) - 21);
    scene_.warnings.push_back(fmt::format(
        "a triangle {} m long passes what stands around the cameras, at an angle to all axes: rays "
        "start {} m off surfaces, and the picture is wrong by about {} %; divide that triangle",
        number_words(size, 2), number_words(offset, 1), number_words(100 * offset / room, 1)));
  }
  // Along an axis, to the farthest corner.
  static double distance_of(const Triangle& t, const std::vector<Vec3d>& world,
                            const Vec3d& middle) {
    double distance = 0;
    for (uint32_t v : t.vertex)
      distance = std::max(distance, max_component(max(world[v] - middle, middle - world[v])));
    return distance;
  }
  // Where half of the triangles lie on either side, along each axis.
  Vec3d middle_of(const std::vector<Vec3d>& world) const {
    Vec3d middle;
    for (int c = 0; c < 3; ++c) {
      std::vector<double> places;
      for (const Triangle& t : scene_.triangles) places.push_back(world[t.vertex[0]][c]);
      const auto half = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
      std::nth_element(places.begin(), half, places.end());
      middle[c] = *half;
    }
    return middle;
  }

  void move_to_canonical(std::vector<Vec3d>& world, double grain) {
    Extent all;
    for (const Triangle& t : scene_.triangles)
      for (uint32_t v : t.vertex) all.add(world[v]);
    const double longest = all.longest();
    if (longest == 0) d_.fail("", "has no triangle with an area");
    if (!(longest >= kShortest && longest <= kLongest))
      d_.fail("", fmt::format("is {} m long, expected {} to {}", longest, kShortest, kLongest));
    if (grain > kCoarsest * longest)
      scene_.warnings.push_back(
          fmt::format("the scene lies so far from the origin that its vertices are known to {} "
                      "m only, {} of its size",
                      number_words(grain, 1), number_words(grain / longest, 1)));
    const Extent extent = extent_of_frame(world, all);
    int exponent = 0;
    const double mantissa = std::frexp(extent.longest(), &exponent);  // in [0.5, 1)
    scene_.frame.scale = std::ldexp(1.0, (mantissa == 0.5 ? 2 : 1) - exponent);
    scene_.frame.centre = extent.middle();
    const double reach = 2 * longest * scene_.frame.scale;  // of any used vertex
    scene_.positions.reserve(world.size() + 1);  // one more, so that a Tracer needs no copy
    for (const Vec3d& p : world)
      scene_.positions.push_back(rounded(scene_.frame.to_canonical(p), std::max(reach, 4.0)));
    world = {};
    for (Camera& c : scene_.cameras) c.position = scene_.frame.to_canonical(c.position);
    for (PunctualLight& l : scene_.lights) to_canonical(d_, scene_.frame, l);
    for (Material& m : scene_.materials)  // per metre -> per canonical length
      m.absorption = Rgb(min(Vec3d(m.absorption) / scene_.frame.scale, Vec3d(1e30)));
  }

  /// Vertices that no triangle uses may lie anywhere, even outside the range of float.
  static Vec3f rounded(const Vec3d& p, double farthest) {
    const Vec3d limit(farthest);
    return Vec3f(max(min(p, limit), -limit));
  }

  void drop_flat_triangles() {
    const size_t dropped = std::erase_if(scene_.triangles, [&](const Triangle& t) {
      const Vec3d p(scene_.positions[t.vertex[0]]);
      const Vec3d n =
          cross(Vec3d(scene_.positions[t.vertex[1]]) - p, Vec3d(scene_.positions[t.vertex[2]]) - p);
      return !(length(n) > 0);
    });
    if (scene_.triangles.empty()) d_.fail("", "has no triangle with an area");
    if (dropped > 0)
      scene_.warnings.push_back(counted(dropped, "triangle") + " without area: left out");
  }

  const Document& d_;
  Scene& scene_;
  Notes notes_;
};

}  // namespace

struct SceneFile::Impl {
  Document document;
  std::string path;

  Motion go_to(double seconds) { return gltf::go_to(document, seconds); }
};

SceneFile::SceneFile(const std::string& path, const std::vector<std::string>& animations)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  open_document(path, impl_->document, animations);
}

SceneFile::~SceneFile() = default;

Scene SceneFile::at(std::optional<double> seconds) {
  Document& document = impl_->document;
  Scene scene;
  scene.path = impl_->path;
  scene.hash = document.hash;
  scene.files = document.files;
  scene.defaults = defaults_of(document.json, impl_->path);
  const Motion motion = impl_->go_to(seconds.value_or(0));
  scene.animations = motion.animations;
  scene.moves = motion.moves;
  if (motion.moves && !seconds) scene.warnings.push_back(beginning_sentence(motion.animations));
  if (!motion.moves && seconds)
    scene.warnings.emplace_back("nothing in the scene is animated: it is the same at all times");
  SceneReader(document, scene).run();
  return scene;
}

SceneFile::Glance SceneFile::glance_at(double seconds) {
  Document& document = impl_->document;
  const bool moves = impl_->go_to(seconds).moves;
  Notes ignored;
  const PlacedNodes nodes = place_nodes(document);
  return {moves ? hash_of_pose(document, nodes) : "", read_cameras(document, nodes, ignored)};
}

Scene read_gltf(const std::string& path, const Pose& pose) {
  return SceneFile(path, pose.animations).at(pose.seconds);
}

}  // namespace tdpt
