#include "libcommon/draw/scene_sheet.h"

#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt::draw {
namespace {

constexpr double kTallest = 820, kLowest = 300, kNarrowestPlan = 430;
constexpr double kAir = 1.06;  // size of the plan's frame relative to the scene
constexpr size_t kMostLamps = 4096;

struct Bounds {
  Vec3d low{INFINITY}, high{-INFINITY};
};
Bounds bounds_of(const Scene& scene) {
  Bounds b;
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) {
      b.low = min(b.low, Vec3d(scene.positions[v]));
      b.high = max(b.high, Vec3d(scene.positions[v]));
    }
  return b;
}

Projection from_above(const Scene& scene, double cut, const Box& panel) {
  const Bounds b = bounds_of(scene);
  Vec3d middle = (b.low + b.high) * 0.5;
  middle.y = cut;
  const Vec3d size = b.high - b.low;
  const double half = 0.5 * kAir * std::max(size.x, size.z * panel.width / panel.height);
  return Projection::flat(middle, {1, 0, 0}, {0, 0, -1}, std::max(half, 1e-6), panel);
}

}  // namespace

SceneSheet::Layout SceneSheet::layout(const Scene& scene, const Camera& camera, double cut,
                                      double legend) {
  const Bounds b = bounds_of(scene);
  const Vec3d size = b.high - b.low;
  Layout l;
  l.cut = (cut - scene.frame.centre.y) * scene.frame.scale;
  if (!(l.cut > b.low.y && l.cut < b.high.y)) l.cut = 0.5 * (b.low.y + b.high.y);
  // Both panels as tall as possible while sharing the width according to their aspects.
  const double seen = std::clamp(camera.aspect > 0 ? camera.aspect : 16.0 / 9, 0.4, 3.0),
               plan = std::clamp(size.x / std::max(size.z, 1e-9), 0.4, 3.0);
  const double room = kSheetWidth - 3 * kMargin;
  const double height = std::round(std::clamp(
      std::min(room / (seen + plan), (room - kNarrowestPlan) / seen), kLowest, kTallest));
  l.camera = {kMargin, kHeading, std::round(height * seen), height};
  l.plan = {l.camera.right() + kMargin, kHeading, room - l.camera.width, height};
  l.legend = {kMargin, l.plan.bottom() + kCaption, room + kMargin, legend};
  l.height = static_cast<int>(l.legend.bottom() + kMargin);
  return l;
}

SceneSheet::SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
                       const std::string& sentence, double cut, double legend)
    : SceneSheet(scene, camera, title, sentence, layout(scene, camera, cut, legend)) {}

SceneSheet::SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
                       const std::string& sentence, const Layout& where)
    : scene_(scene),
      camera_(camera),
      cut_(where.cut),
      tracer_(scene, camera.culls),
      canvas_(kSheetWidth, where.height, kPaper),
      camera_view_(canvas_, tracer_, Projection::of_camera(camera, where.camera)),
      plan_(canvas_, tracer_, from_above(scene, where.cut, where.plan)),
      legend_(where.legend) {
  heading(canvas_, title, sentence);
}

void SceneSheet::paint(const Colouring& colour) {
  camera_view_.paint(colour, kVoid);
  plan_.paint(colour, ink(0xffffff));
  canvas_.clip(plan_.projection().panel);
  for (const Segment& s : section(scene_, cut_))
    canvas_.line(plan_.projection().project(s.a), plan_.projection().project(s.b), 2, kInk);
  canvas_.unclip();
  mark_lamps();
}

void SceneSheet::line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha) {
  for (SceneView* view : {&camera_view_, &plan_})
    view->line(scene_.frame.to_canonical(a), scene_.frame.to_canonical(b), width, c, alpha);
}

void SceneSheet::dot(const Vec3d& place, double radius, const Ink& c, double alpha) {
  for (SceneView* view : {&camera_view_, &plan_})
    view->dot_at(scene_.frame.to_canonical(place), radius, c, alpha);
}

// Ceiling lamps are cut away in the plan: their outlines are drawn anyway.
void SceneSheet::mark_lamps() {
  const Projection& p = plan_.projection();
  canvas_.clip(p.panel);
  size_t lamps = 0;
  for (uint32_t t = 0; t < scene_.triangles.size() && lamps < kMostLamps; ++t) {
    if (!(max_component(scene_.material_of(t).emission) > 0)) continue;
    ++lamps;
    std::vector<Point> corners;
    for (int k = 0; k < 3; ++k) corners.push_back(p.project(Vec3d(scene_.vertex(t, k))));
    canvas_.polygon(corners, kLamp);
    for (size_t k = 0; k < 3; ++k) canvas_.line(corners[k], corners[(k + 1) % 3], 3, kLamp);
  }
  for (const PunctualLight& light : scene_.lights) {
    if (light.kind == PunctualLight::Kind::directional) continue;
    canvas_.disc(p.project(light.position), 7, kInk);
    canvas_.disc(p.project(light.position), 5.5, kLamp);
  }
  canvas_.unclip();
}

void SceneSheet::mark_camera() {
  const Projection& p = plan_.projection();
  canvas_.clip(p.panel);
  const Point at = p.project(camera_.position);
  const double aspect = camera_.aspect > 0 ? camera_.aspect : 16.0 / 9;
  const double half = std::tan(0.5 * camera_.yfov) * aspect;
  for (const double side : {-1.0, 1.0}) {
    const Vec3d w = camera_.forward + camera_.right * (side * half);
    const double across = std::hypot(w.x, w.z);
    if (across < 1e-9) continue;
    canvas_.line(at, {at.x + 46 * w.x / across, at.y + 46 * w.z / across}, 2, kInk);
  }
  canvas_.disc(at, 7, ink(0xffffff));
  canvas_.disc(at, 5, kInk);
  canvas_.unclip();
}

Canvas SceneSheet::finish() {
  mark_camera();
  const Projection& p = plan_.projection();
  for (const SceneView* view : {&camera_view_, &plan_})
    canvas_.frame(view->projection().panel, 1, kFaint);
  caption(
      canvas_, camera_view_.projection().panel,
      camera_.name.empty() ? "The camera's view" : fmt::format("The view of '{}'", camera_.name));
  caption(canvas_, p.panel,
          fmt::format("Plan below y = {} m",
                      number_words(cut_ / scene_.frame.scale + scene_.frame.centre.y)));
  scale_bar(canvas_, {p.panel.right() - 2, p.panel.bottom() + 26},
            p.pixels_per_unit() * scene_.frame.scale);
  return std::move(canvas_);
}

}  // namespace tdpt::draw
