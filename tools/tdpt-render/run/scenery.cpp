#include "tools/tdpt-render/run/scenery.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/denoise/filter_picture.h"
#include "tools/tdpt-render/integrators/passes.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/portals/given_portals.h"
#include "tools/tdpt-render/run/camera_sight.h"

namespace tdpt {

namespace {

constexpr int kPoses = 9;  // of a camera while its shutter is open

// The times of a picture [s]: of those poses, or its own alone.
std::vector<double> moments_of(const RenderArguments& a) {
  const double middle = a.pose.seconds.value_or(0), open = a.lens.shutter / 360 / a.shot.fps;
  if (open == 0) return {middle};
  std::vector<double> times;
  for (int i = 0; i < kPoses; ++i)
    times.push_back(middle + open * (i / static_cast<double>(kPoses - 1) - 0.5));
  return times;
}

// The camera of that name; null if it is not there.
const Camera* camera_of(const SceneFile::Glance& now, const std::string& name) {
  const auto self = std::find_if(now.cameras.begin(), now.cameras.end(),
                                 [&](const Camera& c) { return c.name == name; });
  return self == now.cameras.end() ? nullptr : &*self;
}

bool stands_as(const Camera& a, const Camera& b) {
  return a.position == b.position && a.forward == b.forward && a.up == b.up;
}

}  // namespace

Loaded& Scenery::load(const RenderArguments& a, const cli::Common& common) {
  const bool first = !file_;
  if (a.width > 0 && a.height > 0)
    expect_memory_of_film(a, picture_size(Camera(), a.width, a.height));
  if (first) file_ = std::make_unique<SceneFile>(a.scene, a.pose.animations);
  cli::Common quiet = common;
  quiet.quiet = true;
  if (first || !only_moves_camera(a, quiet)) read(a, first ? common : quiet, first);
  take_poses(a, common);
  in_.lens = a.lens;
  return in_;
}

void Scenery::read(const RenderArguments& a, const cli::Common& common, bool tells) {
  vista_.reset();  // it refers to the scene
  in_ = {};
  in_.scene = file_->at(a.pose.seconds);
  common.also_read(in_.scene.files);
  if (tells)
    for (const std::string& warning : in_.scene.warnings) common.warn(warning);
  in_.files.push_back({a.scene, in_.scene.hash, {}});
  take_camera(a, common);
  in_.sky = add_sky(in_.scene, a.sky, common, in_.files);
  if (tells) warn_of_lamps(in_.scene, common), tell_unit(in_.scene, common);
  note_lost_light(in_.scene, common);
  files_but_portals_ = in_.files.size();
  read_portals(a, common);
}

void Scenery::take_camera(const RenderArguments& a, const cli::Common& common) {
  in_.camera = chosen_camera(in_.scene, a.camera, common);
  in_.size = picture_size(in_.scene, in_.camera, a.width, a.height);
  expect_memory_of_film(a, in_.size);
}

// A camera of the options stands still.
void Scenery::take_poses(const RenderArguments& a, const cli::Common& common) {
  in_.poses.clear();
  if (a.lens.shutter == 0) return;
  bool moves = false, others_move = false;
  for (const double t : moments_of(a)) {
    const SceneFile::Glance now = file_->glance_at(t);
    others_move |= now.pose_hash != in_.scene.pose_hash;
    const Camera* const self = camera_of(now, in_.camera.name);
    if (!self) continue;
    Camera pose = *self;
    pose.position = in_.scene.frame.to_canonical(pose.position);
    moves |= !in_.poses.empty() && !stands_as(pose, in_.poses.front());
    in_.poses.push_back(pose);
  }
  if (!moves) in_.poses.clear();
  const bool placed = !a.camera.look_from.empty() || a.camera.frame;
  if (!moves && (placed || !a.shot.is_given()) && reported_.insert("stands").second)
    common.note(fmt::format("--shutter: the camera {}; nothing is blurred by it",
                            placed ? "is placed by options, and stands" : "stands at that time"));
  if (others_move && reported_.insert("moves").second)
    common.warn(
        "--shutter: something other than the camera moves, and shows sharply, as it stands in the "
        "middle of the exposure");
}

Lens Scenery::lens(const cli::Common& common) {
  Lens lens;
  if (!in_.lens.f_stop) return lens;
  const FilmPlane& film = vista_->view.film;
  const Frame& frame = in_.scene.frame;
  lens.radius = aperture_radius(film, *in_.lens.f_stop) * frame.scale;
  lens.focus =
      in_.lens.focus ? *in_.lens.focus * frame.scale : distance_in_the_middle(*vista_->world, film);
  in_.focus = lens.focus / frame.scale;
  if (!in_.lens.focus && reported_.insert("focus").second)
    common.note(fmt::format("in focus: {}, as the middle of the picture shows {} (--focus)",
                            focus_words(in_.focus),
                            std::isinf(in_.focus) ? "no surface" : "a surface there"));
  return lens;
}

void Scenery::read_portals(const RenderArguments& a, const cli::Common& common) {
  in_.files.resize(files_but_portals_);
  in_.portals.clear();
  in_.portal_hashes.clear();
  for (const std::string& path : a.portals) {
    const GivenPortals given = read_given_portals(path, in_.scene, in_.camera, a.shot.is_given());
    if (!common.quiet || !a.shot.is_given())
      for (const std::string& warning : given.warnings) common.warn(warning);
    for (const std::string& note : given.notes) common.note(note);
    const PortalFile& file = given.file;
    common.also_read(file.files);
    in_.portals.insert(in_.portals.end(), file.portals.begin(), file.portals.end());
    in_.files.push_back({path, file.hash, file.provenance});
    in_.portal_hashes.push_back(file.hash);
  }
}

bool Scenery::only_moves_camera(const RenderArguments& a, const cli::Common& common) {
  const SceneFile::Glance now = file_->glance_at(a.pose.seconds.value_or(0));
  if (now.pose_hash != in_.scene.pose_hash) return false;
  in_.scene.cameras = now.cameras;
  for (Camera& camera : in_.scene.cameras)
    camera.position = in_.scene.frame.to_canonical(camera.position);
  take_camera(a, common);
  read_portals(a, common);
  return true;
}

Vista& Scenery::vista(const cli::Common& common) {
  std::shared_ptr<const World> world = vista_ ? vista_->world : nullptr;
  const WindowSky before = vista_ ? vista_->openings.windows : WindowSky();
  if (!world) {
    OpenWorld open = open_world(in_.scene, in_.camera.culls);
    world = std::move(open.world);
    if (open.uncovered > 0 && reported_.insert("covered").second)
      common.warn(uncovered_sentence(open.uncovered, in_.scene.frame));
  }
  vista_.emplace(std::move(world), in_.camera, in_.size.width, in_.size.height, in_.portals,
                 before);
  warn_of_backs(common);
  vista_->view.blur = CameraBlur(lens(common), in_.poses);
  return *vista_;
}

void Scenery::warn_of_backs(const cli::Common& common) {
  const std::string sentence = backs_sentence(*vista_);
  if (!sentence.empty() && !shows_backs_) common.warn(sentence);
  shows_backs_ = !sentence.empty();
}

PictureSize picture_size(const Camera& camera, int64_t width, int64_t height) {
  constexpr int64_t kMostOnASide = 65536, kMost = int64_t{1} << 27;
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const auto at_least_1 = [](double v) { return std::llround(std::clamp(v, 1.0, 1e6)); };
  if (width == 0 && height == 0) width = 640;
  if (width == 0) width = at_least_1(static_cast<double>(height) * aspect);
  if (height == 0) height = at_least_1(static_cast<double>(width) / aspect);
  if (width > kMostOnASide || height > kMostOnASide || width * height > kMost)
    throw UsageError(fmt::format("a picture of {} x {} pixels is too large, at most {} pixels",
                                 width, height, kMost));
  return {static_cast<int>(width), static_cast<int>(height)};
}

PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height) {
  const SceneDefaults& own = scene.defaults;
  if (width > 0 || height > 0) return picture_size(camera, width, height);
  try {
    return picture_size(camera, own.width, own.height);
  } catch (const UsageError& e) {
    throw InputError(display_name(scene.path),
                     own.place_of(own.width > 0 ? "tdpt_width" : "tdpt_height"), e.what());
  }
}

void expect_memory_of_film(const RenderArguments& a, const PictureSize& size) {
  const TechniqueSet techniques = a.integrator != "auto"
                                      ? integrator_named(a.integrator).mixture.techniques
                                      : (a.portals.empty() ? kTwoWays : kThreeWays);
  const bool halves = keeps_halves(a);
  const Film::Options sums = film_options(a.layers ? techniques : TechniqueSet(), a.alpha, halves);
  const size_t filter = a.filters() && a.shard.empty() ? denoise::kBytesOfPixel : 0;
  expect_memory(fmt::format("{} x {} pixels (--width, --height{}{})", size.width, size.height,
                            a.layers ? ", --layers" : "", halves ? ", --denoise or --aov" : ""),
                (sums.bytes_of_pixel() + filter) * static_cast<uint64_t>(size.width) *
                    static_cast<uint64_t>(size.height));
}

}  // namespace tdpt
