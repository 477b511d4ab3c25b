#include "tools/tdpt-render/portals/given_portals.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/options/shot_options.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {
namespace {

// A limit on cost: every edge of a path is tested against every triangle of the portals.
constexpr size_t kMostTriangles = 4096;
constexpr double kFlat = 0.005;  // of its width, the farthest that a corner may lie off its plane
constexpr double kNear = 4;      // widths of the scene, the farthest that a corner may lie outside

constexpr const char* kExpected = ", expected portals: flat polygons that fill openings";

// The box of everything that light travels between, except the sky and lamps at infinity.
struct Bounds {
  explicit Bounds(const Scene& scene) {
    for (const Vec3f& p : scene.positions) add(Vec3d(p));
    for (const PunctualLight& l : scene.lights)
      if (l.kind != PunctualLight::Kind::directional) add(l.position);
  }
  void add(const Vec3d& v) {
    low = min(low, v);
    high = max(high, v);
  }
  double width() const { return max_component(high - low); }
  double beyond(const Vec3d& v) const { return max_component(max(low - v, v - high)); }

  Vec3d low, high;  // canonical: the scene is around the origin
};

size_t triangles_of(const PortalFile& file) {
  size_t n = 0;
  for (const Portal& portal : file.portals) n += portal.triangles.size();
  return n;
}

class PortalCheck {
 public:
  PortalCheck(const std::string& path, const Scene& scene, const Camera& camera, bool of_shot)
      : name_(display_name(path)), scene_(scene), camera_(camera), of_shot_(of_shot) {
    out_.file = read_portals(path);
  }

  GivenPortals read() {
    const std::string& hash = out_.file.scene_hash;
    if (out_.file.hash == scene_.hash)
      throw InputError(name_, "", std::string("is the scene itself") + kExpected);
    if (out_.file.portals.empty()) {
      // portalfit has said why it found none.
      if (hash.empty())
        out_.notes.push_back("there is no portal in " + name_ + ": rendered as without");
      return std::move(out_);
    }
    if (const size_t n = triangles_of(out_.file); n > kMostTriangles)
      throw InputError(
          name_, "",
          fmt::format("has {} triangles, at most {} are taken{}", n, kMostTriangles, kExpected));
    const Bounds bounds(scene_);
    for (const Portal& portal : out_.file.portals) check(portal, bounds);
    if (!hash.empty() && hash != scene_.identity()) note_another_scene(hash);
    if (!is_for_this_shot()) take_those_of_the_camera();
    return std::move(out_);
  }

 private:
  void check(const Portal& portal, const Bounds& bounds) const {
    const auto refuse = [&](const std::string& why) { throw InputError(name_, portal.name, why); };
    const auto metres = [&](double canonical) {
      return number_words(canonical / scene_.frame.scale, 2) + " m";
    };
    const FlatPortal flat = flattened(portal, scene_.frame);
    if (flat.triangles.empty())
      refuse(fmt::format("is too small, its area is {} m2; draw it as large as its opening",
                         number_words(area_of(portal), 2)));
    if (flat.off > kFlat * flat.width)
      refuse(fmt::format(
          "is not flat: its corners lie up to {} off one plane, at most {} of its width is taken; "
          "flatten it, or draw a portal for each flat part",
          metres(flat.off), percent_words(kFlat)));
    double beyond = 0;
    for (const Corners& t : flat.triangles)
      for (const Vec3d& corner : t) beyond = std::max(beyond, bounds.beyond(corner));
    if (beyond > kNear * bounds.width())
      refuse(fmt::format(
          "reaches {} beyond the scene, which is {} wide; draw it in its opening, in metres",
          metres(beyond), metres(bounds.width())));
  }

  void note_another_scene(const std::string& identity) {
    if (!scene_.is_scene_of(identity))
      out_.notes.push_back(name_ + " was made for another state of the scene, or for another one");
    else if (scene_.is_pose_of(identity))
      out_.notes.push_back(name_ +
                           " was made for the scene under another environment or other "
                           "--set light-units");
    else if (!of_shot_)
      out_.notes.push_back(name_ + " was made for the scene at another time of its animations");
  }

  // Portals found for poses of the camera along its way serve all of its frames: which of them do
  // is measured [exploration.h]. False if the file has no such poses.
  bool is_for_this_shot() const {
    return of_shot_ && std::any_of(out_.file.made_for.begin(), out_.file.made_for.end(),
                                   [&](const std::string& text) {
                                     const auto made_for = parse_viewpoint(text);
                                     return made_for &&
                                            frame_of_camera(made_for->name, camera_.name);
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

  std::string name_;
  const Scene& scene_;
  const Camera& camera_;
  bool of_shot_;
  GivenPortals out_;
};

}  // namespace

GivenPortals read_given_portals(const std::string& path, const Scene& scene, const Camera& camera,
                                bool of_shot) {
  return PortalCheck(path, scene, camera, of_shot).read();
}

}  // namespace tdpt
