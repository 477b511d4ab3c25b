#include "tools/tdpt-render/portals/given_portals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/number_words.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/formats/viewpoint.h"
#include "shaders/shared/path/point.h"
#include "tools/tdpt-render/portals/portal_fit.h"
#include "tools/tdpt-render/portals/portal_mesh.h"

namespace tdpt {
namespace {

// A limit on cost: every edge of a path is tested against every triangle of the portals.
constexpr size_t kMostTriangles = 4096;
constexpr double kFarLarger = 8;      // times the scene's extent
constexpr double kSameCorner = 1e-6;  // canonical
// A few triangles of a scene may lie where portals do: panes, the glass of a lamp.
constexpr size_t kFewTriangles = 8;
constexpr size_t kSeveral = 3;  // bodies

struct Box {
  Vec3d low = Vec3d(std::numeric_limits<double>::infinity()),
        high = Vec3d(-std::numeric_limits<double>::infinity());
  void add(const Vec3d& v) {
    low = min(low, v);
    high = max(high, v);
  }
  double extent() const { return max_component(high - low); }
  bool holds(const Box& other, double margin) const {
    for (int c = 0; c < 3; ++c)
      if (other.low[c] < low[c] - margin || other.high[c] > high[c] + margin) return false;
    return true;
  }
  bool touches(const Box& other, double margin) const {
    for (int c = 0; c < 3; ++c)
      if (low[c] > other.high[c] + margin || high[c] < other.low[c] - margin) return false;
    return true;
  }
};

Box box_of(const Portal& portal, const Frame& frame) {
  Box box;
  for (const auto& t : portal.triangles)
    for (const uint32_t v : t) box.add(frame.to_canonical(portal.vertices[v]));
  return box;
}
// Bounds of everything that light travels between, except the sky and lamps at infinity.
Box box_of(const Scene& scene) {
  Box box;
  for (const Vec3f& p : scene.positions) box.add(Vec3d(p));
  for (const PunctualLight& l : scene.lights)
    if (l.kind != PunctualLight::Kind::directional) box.add(l.position);
  return box;
}

size_t triangles_of(const PortalFile& file) {
  size_t n = 0;
  for (const Portal& portal : file.portals) n += portal.triangles.size();
  return n;
}

// Number of triangles of the file that are also the scene's, compared by their centres.
size_t shared_triangles(const PortalFile& file, const Scene& scene) {
  std::vector<Vec3d> middles;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    middles.push_back(
        (Vec3d(scene.vertex(t, 0)) + Vec3d(scene.vertex(t, 1)) + Vec3d(scene.vertex(t, 2))) / 3);
  const auto by_x = [](const Vec3d& a, const Vec3d& b) { return a.x < b.x; };
  std::sort(middles.begin(), middles.end(), by_x);
  size_t n = 0;
  for (const Portal& portal : file.portals)
    for (const auto& t : portal.triangles) {
      Vec3d middle;
      for (const uint32_t v : t) middle += scene.frame.to_canonical(portal.vertices[v]) / 3;
      auto at = std::lower_bound(middles.begin(), middles.end(), middle - Vec3d(kSameCorner), by_x);
      while (at != middles.end() && at->x <= middle.x + kSameCorner &&
             length(*at - middle) > kSameCorner)
        ++at;
      n += at != middles.end() && at->x <= middle.x + kSameCorner;
    }
  return n;
}

class Judge {
 public:
  Judge(const std::string& path, const Scene& scene, const Camera& camera,
        std::optional<int64_t> frame)
      : name_(display_name(path)),
        scene_(scene),
        camera_(camera),
        frame_(frame),
        box_(box_of(scene)) {
    out_.file = read_portals(path);
  }

  GivenPortals judged() {
    const std::string& hash = out_.file.scene_hash;
    if (out_.file.hash == scene_.hash) refuse("is the scene itself");
    if (out_.file.portals.empty()) {
      // portalfit has said why it found none.
      if (hash.empty())
        out_.notes.push_back("there is no portal in " + name_ + ": rendered as without");
      return std::move(out_);
    }
    refuse_triangles_of_the_scene();
    if (const size_t n = triangles_of(out_.file); n > kMostTriangles)
      throw InputError(
          name_, "",
          fmt::format("has {} triangles, expected a portal of at most {}", n, kMostTriangles));
    if (!hash.empty() && hash != scene_.identity()) tell_of_another_scene(hash);
    if (!is_for_this_shot()) take_those_of_the_camera();
    if (out_.file.portals.empty()) return std::move(out_);
    tidy_all();
    std::erase_if(out_.file.portals, [&](const Portal& portal) { return is_elsewhere(portal); });
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const std::string& found) const {
    throw InputError(name_, "", found + ", expected portals: planar polygons that fill openings");
  }
  void warn(const Portal& portal, const std::string& words) {
    out_.warnings.push_back(portal.name + ": " + words);
  }

  void tell_of_another_scene(const std::string& identity) {
    if (!scene_.is_scene_of(identity))
      out_.notes.push_back(name_ + " was made for another state of the scene, or for another one");
    else if (scene_.is_pose_of(identity))
      out_.notes.push_back(name_ +
                           " was made for the scene under another environment or other "
                           "--set light-units");
    else if (!frame_)
      out_.notes.push_back(name_ + " was made for the scene at another time of its animations");
  }

  // Portals found for poses of the camera along its way serve all of its frames: which of them do
  // is measured [exploration.h]. False if the file has no such poses.
  bool is_for_this_shot() const {
    return frame_ && std::any_of(out_.file.made_for.begin(), out_.file.made_for.end(),
                                 [&](const std::string& text) {
                                   const auto made_for = parse_viewpoint(text);
                                   return made_for && frame_of_camera(made_for->name, camera_.name);
                                 });
  }

  // Which openings are narrow depends on where the camera stands. All portals are kept for a camera
  // that the file does not know, with a warning.
  void take_those_of_the_camera() {
    const Viewpoint used = viewpoint_of(scene_.frame, camera_);
    std::string warning;
    for (const std::string& text : out_.file.made_for) {
      const auto made_for = parse_viewpoint(text);
      if (!made_for) continue;
      const std::string words = words_of_difference(*made_for, used, 2 / scene_.frame.scale);
      if (words.empty()) return leave_out_others(made_for->name);
      if (warning.empty() || made_for->name == used.name)
        warning = fmt::format(
            "{}: its portals were found for camera \"{}\"; \"{}\" is {}: portals "
            "belong to a camera",
            name_, made_for->name, used.name, words);
    }
    if (!warning.empty()) out_.warnings.push_back(warning);
  }

  // Those that serve other cameras of the file than the one of this name.
  void leave_out_others(const std::string& camera) {
    std::vector<Portal>& portals = out_.file.portals;
    const size_t all = portals.size();
    std::erase_if(portals, [&](const Portal& portal) {
      return !portal.cameras.empty() && !portal.cameras.contains(camera);
    });
    for (Portal& portal : portals)
      if (const auto own = portal.cameras.find(camera); own != portal.cameras.end())
        portal.figures["flux_share"] = own->second;
    if (portals.size() < all)
      out_.notes.push_back(
          fmt::format("{}: {} of its {} portals serve other cameras and are left out", name_,
                      all - portals.size(), all));
  }

  void refuse_triangles_of_the_scene() const {
    const size_t all = triangles_of(out_.file), scene = scene_.triangles.size();
    if (all <= kFewTriangles) return;
    const size_t shared = shared_triangles(out_.file, scene_);
    if (2 * shared > all && (2 * shared > scene || shared > kMostTriangles))
      refuse(fmt::format("holds {} of the scene's {} triangles", shared, scene));
  }

  // Closed bodies are left out, unless the file is a whole scene.
  void tidy_all() {
    std::vector<PortalMesh> found;
    size_t bodies = 0;
    double body_area = 0, area = 0;
    bool large = false;
    for (Portal& portal : out_.file.portals) {
      area += area_of(portal);
      const PortalMesh& mesh = found.emplace_back(tidy(portal));
      if (mesh.shape < PortalMesh::folded) continue;
      ++bodies;
      body_area += area_of(portal);
      large |= 2 * box_of(portal, scene_.frame).extent() > box_.extent();
    }
    const bool furnished = out_.file.cameras > 0 && out_.file.lamps > 0;
    if (2 * body_area > area && (bodies >= kSeveral || large || furnished))
      refuse(fmt::format("holds {} bodies among {} meshes", bodies, found.size()));
    if (furnished && found.size() > kSeveral)
      refuse(fmt::format("holds a camera, lamps and {} meshes", found.size()));
    std::vector<Portal> kept;
    for (size_t i = 0; i < found.size(); ++i) {
      const Portal& portal = out_.file.portals[i];
      tell(portal, found[i]);
      if (found[i].shape < PortalMesh::folded) kept.push_back(portal);
    }
    out_.file.portals = std::move(kept);
  }

  void tell(const Portal& portal, const PortalMesh& mesh) {
    if (mesh.shape == PortalMesh::body)
      return warn(portal, "is a closed body, expected a planar polygon: left out");
    if (mesh.shape == PortalMesh::folded)
      return warn(portal,
                  "is folded, its triangles face all ways, expected a planar polygon: left out");
    if (mesh.shape == PortalMesh::flattened)
      warn(portal, fmt::format("is not planar, corners lie {} m off its plane: laid into it",
                               number_words(mesh.off, 2)));
    if (mesh.shape == PortalMesh::lid)
      warn(portal, "is not planar, but its rim is: the polygon in its rim is used");
    if (mesh.shape == PortalMesh::bent)
      warn(portal, fmt::format("is not planar: used as {} planes", mesh.planes));
    if (mesh.turned)
      out_.notes.push_back(portal.name +
                           ": some triangles faced another way than their neighbours: turned");
    if (mesh.shape == PortalMesh::planar && portal.triangles.size() < mesh.triangles)
      out_.notes.push_back(fmt::format("{}: {} triangles cover the same as its {}", portal.name,
                                       portal.triangles.size(), mesh.triangles));
  }

  // Whether light from infinity passes there on its way to the scene.
  bool lit_from_afar(const Box& box) const {
    const bool parallel = std::any_of(
        scene_.lights.begin(), scene_.lights.end(),
        [](const PunctualLight& l) { return l.kind == PunctualLight::Kind::directional; });
    return (scene_.sky || parallel) &&
           length(max(box.high, Vec3d() - box.low)) < shader::kBeforeTheScene;
  }

  bool is_elsewhere(const Portal& portal) {
    constexpr double kMargin = 1e-3;
    const Box box = box_of(portal, scene_.frame);
    const bool outside = !box.touches(box_, kMargin * box_.extent());
    std::string why;
    if (outside)
      why = "lies outside the scene";
    else if (box.extent() > kFarLarger * box_.extent())
      why = fmt::format("is {} times as large as the scene",
                        number_words(box.extent() / box_.extent(), 2));
    else
      return false;
    if (!tracer_) tracer_ = std::make_unique<Tracer>(scene_);
    std::string unit = unit_words(portal, *tracer_, scene_.frame);
    if (outside && unit.empty() && lit_from_afar(box)) return false;
    if (unit.empty()) unit = unit_by_size(portal);
    warn(portal, why + (unit.empty() ? "" : ", " + unit) + ": left out");
    return true;
  }

  // For a portal that fills no opening: the unit in which one as large as the scene would lie in
  // it.
  std::string unit_by_size(const Portal& portal) const {
    const double extent = box_of(portal, scene_.frame).extent();
    if (2 * extent < box_.extent()) return "";
    for (const auto& [factor, words] : {std::pair(0.01, "perhaps drawn in centimetres"),
                                        std::pair(0.001, "perhaps drawn in millimetres")}) {
      Portal smaller = portal;
      for (Vec3d& v : smaller.vertices) v = v * factor;
      if (box_.holds(box_of(smaller, scene_.frame), 0.02 * box_.extent())) return words;
    }
    return "";
  }

  std::string name_;
  const Scene& scene_;
  const Camera& camera_;
  std::optional<int64_t> frame_;
  Box box_;
  std::unique_ptr<Tracer> tracer_;  // for a portal in the wrong place
  GivenPortals out_;
};

}  // namespace

GivenPortals read_given_portals(const std::string& path, const Scene& scene, const Camera& camera,
                                std::optional<int64_t> frame) {
  return Judge(path, scene, camera, frame).judged();
}

}  // namespace tdpt
