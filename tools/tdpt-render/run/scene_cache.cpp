#include "tools/tdpt-render/run/scene_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/denoise/filter_picture.h"
#include "tools/tdpt-render/integrators/passes.h"
#include "tools/tdpt-render/portals/given_portals.h"

namespace tdpt {
// ---- What rays from the camera tell ----

namespace {

constexpr int kRays = 32;             // along each side of the film
constexpr double kLeastShare = 0.01;  // below which there is no warning

Vec3d direction_of(const FilmPlane& film, int ray) {
  return film.direction((ray % kRays + 0.5) / kRays * film.width(),
                        (ray / kRays + 0.5) / kRays * film.height());
}

bool is_culled_back(const Scene& scene, const Hit& hit, const Vec3d& w) {
  return dot(hit.normal, w) > 0 && scene.single_sided(hit.triangle);
}

// Whether each ray meets the back of a surface, as in a wall.
bool sees_only_backs(const Vista& vista) {
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = direction_of(vista.view.film, i);
    Hit hit;
    if (!vista.world->tracer.first_seen(vista.view.film.position(), w, hit) ||
        dot(hit.normal, w) < 0)
      return false;
  }
  return true;
}

}  // namespace

std::string backs_sentence(const Vista& vista) {
  const FilmPlane& film = vista.view.film;
  std::vector<int> met(vista.world->scene.materials.size());
  int backs = 0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = direction_of(film, i);
    Hit hit;
    if (!vista.world->tracer.first_seen(film.position(), w, hit) ||
        !is_culled_back(vista.world->scene, hit, w))
      continue;
    ++backs;
    ++met[vista.world->scene.triangles[hit.triangle].material];
  }
  const double share = static_cast<double>(backs) / (kRays * kRays);
  if (share < kLeastShare) return "";
  const auto most = std::max_element(met.begin(), met.end());
  const std::string& name =
      vista.world->scene.materials[static_cast<size_t>(most - met.begin())].name;
  return fmt::format(
      "the camera sees the backs of single-sided surfaces in {:.0f} % of the picture, most of all "
      "of {}: glTF viewers do not draw them (--cull)",
      100 * share,
      name.empty() ? fmt::format("materials[{}]", most - met.begin())
                   : "material \"" + shown(name, 60) + "\"");
}

double distance_in_the_middle(const World& world, const FilmPlane& film) {
  std::vector<uint32_t> passed;
  Tracer::Sheet sheet;
  double passes = 1;
  while (world.tracer.first_sheet_seen(film.position(), film.forward(), passed, sheet)) {
    passes *= 1 - sheet.coverage;
    if (passes < 0.5) return sheet.hit.distance;
    passed.push_back(sheet.hit.triangle);
  }
  return std::numeric_limits<double>::infinity();
}

std::string why_black(const Vista& vista) {
  if (sees_only_backs(vista))
    return "the camera sees only backs of surfaces: does it stand in a wall?";
  return "are the samples too few, or is a door shut?";
}

// ---- The cache ----

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

LoadedScene& SceneCache::load(const RenderArguments& a, const cli::Common& common) {
  if (a.width > 0 && a.height > 0)
    expect_memory_of_film(a, picture_size({}, {}, a.width, a.height));
  first_ = !file_;
  cli::Common quiet = common;
  quiet.quiet |= !first_;
  if (first_) file_ = std::make_unique<SceneFile>(a.scene, a.pose.animations);
  if (first_ || !only_moves_camera(a, quiet)) read(a, quiet);
  take_poses(a, quiet);
  return in_;
}

void SceneCache::read(const RenderArguments& a, const cli::Common& common) {
  vista_.reset();  // it refers to the scene
  in_ = {};
  in_.scene = file_->at(a.pose.seconds);
  common.also_read(in_.scene.files);
  if (first_)
    for (const std::string& warning : in_.scene.warnings) common.warn(warning);
  in_.files.push_back({a.scene, in_.scene.hash, {}});
  take_camera(a, common);
  add_sky(in_.scene, a.sky, common, in_.files);
  if (first_) {
    note_unit(in_.scene, common);
    note_lost_light(in_.scene, common);
  }
  files_but_portals_ = in_.files.size();
  read_portals(a, common);
}

void SceneCache::take_camera(const RenderArguments& a, const cli::Common& common) {
  in_.camera = chosen_camera(in_.scene, a.camera, common);
  in_.size = picture_size(in_.scene, in_.camera, a.width, a.height);
  expect_memory_of_film(a, in_.size);
}

// A camera of the options stands still.
void SceneCache::take_poses(const RenderArguments& a, const cli::Common& common) {
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
  if (others_move && first_)
    common.warn(
        "--shutter: something other than the camera moves, and shows sharply, as it stands in the "
        "middle of the exposure");
}

Lens SceneCache::lens(const LensArguments& a, bool tells, const cli::Common& common) {
  Lens lens;
  if (!a.f_stop) return lens;
  const FilmPlane& film = vista_->view.film;
  const double scale = in_.scene.frame.scale;
  lens.radius = aperture_radius(film, *a.f_stop) * scale;
  lens.focus = a.focus ? *a.focus * scale : distance_in_the_middle(*vista_->world, film);
  in_.focus = lens.focus / scale;
  if (!a.focus && tells)
    common.note(fmt::format("in focus: {}, as the middle of the picture shows {} (--focus)",
                            focus_words(in_.focus),
                            std::isinf(in_.focus) ? "no surface" : "a surface there"));
  return lens;
}

void SceneCache::read_portals(const RenderArguments& a, const cli::Common& common) {
  in_.files.resize(files_but_portals_);
  in_.portals.clear();
  in_.portal_hashes.clear();
  for (const std::string& path : a.portals) {
    const GivenPortals given = read_given_portals(path, in_.scene, in_.camera, a.shot.is_given());
    for (const std::string& warning : given.warnings)
      if (first_) common.warn(warning);
    for (const std::string& note : given.notes) common.note(note);
    const PortalFile& file = given.file;
    common.also_read(file.files);
    in_.portals.insert(in_.portals.end(), file.portals.begin(), file.portals.end());
    in_.files.push_back({path, file.hash, file.provenance});
    in_.portal_hashes.push_back(file.hash);
  }
}

bool SceneCache::only_moves_camera(const RenderArguments& a, const cli::Common& common) {
  const SceneFile::Glance now = file_->glance_at(a.pose.seconds.value_or(0));
  if (now.pose_hash != in_.scene.pose_hash) return false;
  in_.scene.cameras = now.cameras;
  for (Camera& camera : in_.scene.cameras)
    camera.position = in_.scene.frame.to_canonical(camera.position);
  take_camera(a, common);
  read_portals(a, common);
  return true;
}

Vista& SceneCache::vista(const RenderArguments& a, const cli::Common& common) {
  const bool tells = !std::exchange(showed_, true);
  std::shared_ptr<const World> world = vista_ ? vista_->world : nullptr;
  const WindowSky before = vista_ ? vista_->openings.windows : WindowSky();
  if (!world) {
    OpenWorld open = open_world(in_.scene, in_.camera.culls);
    world = std::move(open.world);
    if (open.uncovered > 0 && tells)
      common.warn(uncovered_sentence(open.uncovered, in_.scene.frame));
  }
  vista_.emplace(std::move(world), in_.camera, in_.size.width, in_.size.height, in_.portals,
                 before);
  if (const std::string sentence = tells ? backs_sentence(*vista_) : ""; !sentence.empty())
    common.warn(sentence);
  vista_->view.blur = CameraBlur(lens(a.lens, tells, common), in_.poses);
  return *vista_;
}

PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height) {
  constexpr int64_t kMostOnASide = 65536, kMost = int64_t{1} << 27;
  const SceneDefaults& own = scene.defaults;
  const bool by_scene = width == 0 && height == 0 && (own.width > 0 || own.height > 0);
  if (by_scene) width = own.width, height = own.height;
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const auto at_least_1 = [](double v) { return std::llround(std::clamp(v, 1.0, 1e6)); };
  if (width == 0 && height == 0) width = 640;
  if (width == 0) width = at_least_1(static_cast<double>(height) * aspect);
  if (height == 0) height = at_least_1(static_cast<double>(width) / aspect);
  if (width > kMostOnASide || height > kMostOnASide || width * height > kMost) {
    const std::string fault = fmt::format(
        "a picture of {} x {} pixels is too large, at most {} pixels", width, height, kMost);
    if (!by_scene) throw UsageError(fault);
    throw InputError(display_name(scene.path),
                     own.place_of(own.width > 0 ? "tdpt_width" : "tdpt_height"), fault);
  }
  return {static_cast<int>(width), static_cast<int>(height)};
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
