#include "libcommon/options/camera_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/math/reach.h"

namespace tdpt {

namespace {

constexpr double kRadians = std::numbers::pi / 180;
constexpr double kLongerSide = 0.036;  // of the film [m]
constexpr double kUsualFov = 45;       // [deg]
constexpr double kFarthest = 1e6;      // canonical, as for the scene's cameras
constexpr double kLeastAngle = 1e-4;   // between up and the view direction [rad]
constexpr double kMargin = 1.05;       // of --frame, on the scene's size
const Vec3d kBefore{0.5, 0.4, 1};      // from the middle to the camera of --frame: +Z is in front

Vec3d three_numbers(const char* option, const std::string& text) {
  Vec3d v;
  const char *at = text.data(), *const end = at + text.size();
  for (int c = 0; c < 3; ++c) {
    const auto [next, error] = std::from_chars(at, end, v[c]);
    const bool last = c == 2;
    if (error != std::errc() || !std::isfinite(v[c]) || (last ? next != end : next == end) ||
        (!last && *next != ','))
      throw UsageError(fmt::format("{} {}: expected X,Y,Z, three numbers", option, text));
    at = next + 1;
  }
  return v;
}

void check(const CameraArguments& a) {
  const bool placed = !a.look_from.empty() || !a.look_at.empty();
  if (a.look_from.empty() != a.look_at.empty())
    throw UsageError("--look-from and --look-at go together");
  if (placed && a.frame) throw UsageError("--frame: --look-from says where the camera stands");
  if (!a.names.empty() && (placed || a.frame))
    throw UsageError(fmt::format("--camera {}: {} says where the camera stands", a.names[0],
                                 placed ? "--look-from" : "--frame"));
  if (!a.up.empty() && !placed) throw UsageError("--up goes with --look-from");
  if (a.fov != 0 && !placed && !a.frame) throw UsageError("--fov goes with --look-from or --frame");
}

// `up` must not be parallel to `forward`.
void turn(Camera& camera, const Vec3d& forward, const Vec3d& up) {
  camera.forward = forward;
  camera.right = normalize(cross(forward, up));
  camera.up = cross(camera.right, forward);
}

// Default up direction. A camera that looks straight down has -Z, the far side, at its top.
Vec3d usual_up(const Vec3d& forward) {
  const Vec3d up{0, 1, 0};
  if (length(cross(forward, up)) > kLeastAngle) return up;
  return {0, 0, forward.y < 0 ? -1.0 : 1.0};
}

Vec3d given_up(const CameraArguments& a, const Vec3d& forward) {
  const Vec3d up = three_numbers("--up", a.up);
  if (!(length(up) > 0) || !(length(cross(forward, normalize(up))) > kLeastAngle))
    throw UsageError(fmt::format("--up {}: is no direction across the view", a.up));
  return normalize(up);
}

Camera placed_camera(const Scene& scene, const CameraArguments& a) {
  const Vec3d from = three_numbers("--look-from", a.look_from);
  const Vec3d at = three_numbers("--look-at", a.look_at);
  Camera camera;
  camera.name = "--look-from";
  camera.position = scene.frame.to_canonical(from);
  const Vec3d way = scene.frame.to_canonical(at) - camera.position;
  if (!(length(camera.position) <= kFarthest))
    throw UsageError(
        fmt::format("--look-from {}: {:.3g} times the scene's size away, expected at "
                    "most {:.0g}",
                    a.look_from, length(camera.position), kFarthest));
  if (!(length(way) > 0) || !std::isfinite(length(way)))
    throw UsageError(fmt::format("--look-at {}: is no place other than --look-from", a.look_at));
  const Vec3d forward = normalize(way);
  turn(camera, forward, a.up.empty() ? usual_up(forward) : given_up(a, forward));
  return camera;
}

}  // namespace

void declare_camera_options(cli::Options& options, CameraArguments& a) {
  options.part(cli::Part::camera);
  options.option("--camera", a.names, "NAME",
                 "Camera of the scene to use; default the one it names, else the first. ffgraph "
                 "and tdpt take several (NAME,NAME) or all");
  options.option("--look-from", a.look_from, "X,Y,Z",
                 "Place of a camera of one's own, metres in the axes of the file");
  options.option("--look-at", a.look_at, "X,Y,Z", "Place that it looks at");
  options.option("--up,--set up", a.up, "X,Y,Z",
                 "Direction that is up in the picture of --look-from; default 0,1,0");
  options.option(
      "--fov,--set fov", a.fov, "DEG",
      fmt::format("Full vertical angle of --look-from and --frame; default {}", kUsualFov), 0.01,
      179);
  options.flag("--frame", a.frame,
               "Camera that has all of the scene in view and culls, as viewers open a file");
  options.flag("--cull", a.cull,
               "A cutaway: the camera sees through the backs of single-sided surfaces");
}

namespace {

template <class Visit>
void for_each_corner(const Scene& scene, const Visit& visit) {
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) visit(Vec3d(scene.positions[v]));
}

Vec3d middle_of(const Scene& scene) {
  Extent box;
  for_each_corner(scene, [&](const Vec3d& p) { box.add(p); });
  return (box.low + box.high) * 0.5;
}

// Its position as options, for users who want to adjust it.
std::string frame_sentence(const Scene& scene, const Camera& camera) {
  const auto place = [&](const Vec3d& canonical) {
    const Vec3d p = scene.frame.to_metres(canonical);
    return fmt::format("{:.10g},{:.10g},{:.10g}", p.x, p.y, p.z);
  };
  return fmt::format("--frame is about --look-from {} --look-at {} --fov {:.3g} --cull",
                     place(camera.position), place(middle_of(scene)), camera.yfov / kRadians);
}

}  // namespace

Camera framing_camera(const Scene& scene, double yfov) {
  const Vec3d middle = middle_of(scene);
  Camera camera;
  camera.name = "--frame";
  camera.yfov = yfov;
  turn(camera, -normalize(kBefore), {0, 1, 0});
  // Seen from distance d, a corner at p from the middle is in view if |right.p| and |up.p| are less
  // than tan(yfov / 2) (d + forward.p).
  double distance = 0;
  for_each_corner(scene, [&](const Vec3d& corner) {
    const Vec3d p = corner - middle;
    const double aside = std::max(std::abs(dot(camera.right, p)), std::abs(dot(camera.up, p)));
    distance = std::max(distance, kMargin * aside / std::tan(0.5 * yfov) - dot(camera.forward, p));
  });
  camera.position = middle - camera.forward * distance;
  return camera;
}

namespace {

// `name`: of a camera in the scene; empty: the default one.
Camera one_camera(const Scene& scene, const CameraArguments& a, const std::string& name,
                  const cli::Common& common) {
  const double yfov = (a.fov > 0 ? a.fov : kUsualFov) * kRadians;
  const bool placed = !a.look_from.empty();
  Camera camera = placed    ? placed_camera(scene, a)
                  : a.frame ? framing_camera(scene, yfov)
                            : scene.camera(name);
  if (placed) camera.yfov = yfov;
  camera.culls = a.cull || a.frame;
  if (a.frame) common.note(frame_sentence(scene, camera));
  if (!placed && !a.frame && name.empty() && scene.defaults.camera.empty() &&
      scene.cameras.size() > 1)
    common.note(fmt::format("camera \"{}\", one of {}; --camera NAME takes another", camera.name,
                            scene.cameras.size()));
  return camera;
}

bool has_camera(const Scene& scene, const std::string& name) {
  return std::any_of(scene.cameras.begin(), scene.cameras.end(),
                     [&](const Camera& c) { return c.name == name; });
}

// Those of one value of --camera.
std::vector<std::string> names_in(const Scene& scene, const std::string& given) {
  std::vector<std::string> names;
  if (has_camera(scene, given)) return {given};
  if (given == "all") {
    for (const Camera& c : scene.cameras) names.push_back(c.name);
    return names;
  }
  for (size_t at = 0; at <= given.size();) {
    const size_t end = std::min(given.find(',', at), given.size());
    if (end == at)
      throw UsageError(fmt::format("--camera {}: a name is missing beside a comma", given));
    names.push_back(given.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

}  // namespace

std::vector<std::string> names_of_cameras(const Scene& scene,
                                          const std::vector<std::string>& given) {
  std::vector<std::string> names;
  for (const std::string& value : given)
    for (std::string& name : names_in(scene, value))
      if (std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(std::move(name));
  return names;
}

Camera chosen_camera(const Scene& scene, const CameraArguments& a, const cli::Common& common) {
  if (const size_t n = names_of_cameras(scene, a.names).size(); n > 1)
    throw UsageError(fmt::format("--camera: {} are given, expected one; tdpt renders several", n));
  return chosen_cameras(scene, a, common)[0];
}

std::vector<Camera> chosen_cameras(const Scene& scene, const CameraArguments& a,
                                   const cli::Common& common) {
  check(a);
  std::vector<std::string> names = names_of_cameras(scene, a.names);
  if (names.empty()) names.emplace_back();
  std::vector<Camera> cameras;
  for (const std::string& name : names) cameras.push_back(one_camera(scene, a, name, common));
  if (const std::string missing = scene.missing_camera(); !missing.empty()) common.warn(missing);
  return cameras;
}

void declare_lens_options(cli::Options& options, LensArguments& a) {
  options.part(cli::Part::camera);
  options.option("--f-stop", a.f_stop, "N",
                 "Depth of field: f-number of the lens, as 2.8, on a film 36 mm along its longer "
                 "side; default a pinhole",
                 0.01, 1e6);
  options.option(
      "--focus", a.focus, "METRES",
      "Distance in front of the camera that --f-stop shows sharply; default that of what "
      "the middle of the picture shows",
      1e-6, 1e9);
  options.option("--shutter", a.shutter, "DEG",
                 "Motion blur of a moving camera: 360 is open from frame to frame, 180 for half of "
                 "the time, about the frame's; default an instant",
                 0, 360);
}

void check_lens(const LensArguments& a, const ShotArguments& shot, const Pose& pose,
                const std::string& device) {
  if (a.focus && !a.f_stop) throw UsageError("--focus: goes with --f-stop; a pinhole needs none");
  if (a.shutter > 0 && !shot.is_given() && !pose.seconds)
    throw UsageError("--shutter: needs --frames or --at, the time at which it is open");
  if (device.starts_with("gpu") && (a.f_stop || a.shutter > 0))
    throw UsageError(fmt::format("{}: --device gpu cannot blur; render with --device cpu",
                                 a.f_stop ? "--f-stop" : "--shutter"));
}

double aperture_radius(const FilmPlane& film, double f_stop) {
  const double focal_length = 0.5 * kLongerSide / std::max(film.half_width(), film.half_height());
  return 0.5 * focal_length / f_stop;
}

std::string focus_words(double metres) {
  return std::isinf(metres) ? "infinity" : number_words(metres, 3) + " m";
}

std::string shutter_words(const LensArguments& a, const ShotArguments& shot) {
  if (a.shutter == 0) return "an instant";
  return fmt::format("{} degrees at {} frames per second", a.shutter, shot.fps);
}

}  // namespace tdpt
