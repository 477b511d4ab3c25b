#include "libcommon/draw/scene_sheet.h"

#include <cmath>

#include <fmt/format.h>

namespace tdpt::draw {
namespace {
constexpr double kTallest = 820, kLowest = 300, kNarrowestPlan = 430;
}  // namespace

SceneSheet::Layout SceneSheet::layout(const Scene& scene, const Camera& camera,
                                      const Tracer& tracer, const std::vector<Vec3d>& places,
                                      double legend) {
  Layout l;
  const Vec3d eye = scene.frame.to_metres(camera.position);
  l.storeys = storeys_to_draw(scene, tracer, eye, places);
  l.extent = extent_of(l.storeys, {eye});
  // Camera and first plan as tall as possible while sharing the width according to their aspects;
  // the other plans, of the same size, in rows below.
  const double seen = std::clamp(camera.aspect > 0 ? camera.aspect : 16.0 / 9, 0.4, 3.0),
               plan = std::clamp(l.extent.aspect(), 0.4, 3.0);
  const double room = kSheetWidth - 3 * kMargin;
  const double height = std::round(std::clamp(
      std::min(room / (seen + plan), (room - kNarrowestPlan) / seen), kLowest, kTallest));
  l.camera = {kMargin, kHeading, std::round(height * seen), height};
  Box at{l.camera.right() + kMargin, kHeading, room - l.camera.width, height};
  for (size_t k = 0; k < l.storeys.size(); ++k) {
    if (at.right() > kSheetWidth - kMargin + 1)
      at = {kMargin, at.bottom() + Plan::kCaptionRoom, at.width, height};
    l.plans.push_back(at);
    at.x = at.right() + kMargin;
  }
  l.legend = {kMargin, l.plans.back().bottom() + kCaption, room + kMargin, legend};
  return l;
}

SceneSheet::SceneSheet(const Scene& scene, const Camera& camera, const std::string& title,
                       const std::string& sentence, const std::vector<Vec3d>& places, double legend)
    : scene_(scene),
      camera_(camera),
      tracer_(scene, camera.culls),
      layout_(layout(scene, camera, tracer_, places, legend)),
      canvas_(kSheetWidth, static_cast<int>(layout_.legend.bottom() + kMargin), kPaper),
      camera_view_(canvas_, tracer_, Projection::of_camera(camera, layout_.camera)),
      legend_(layout_.legend) {
  for (size_t k = 0; k < layout_.storeys.size(); ++k)
    plans_.emplace_back(canvas_, scene, tracer_, layout_.storeys[k], layout_.extent,
                        layout_.plans[k]);
  heading(canvas_, title, sentence);
}

void SceneSheet::paint(const Colouring& colour) {
  camera_view_.paint(colour, kVoid);
  for (Plan& plan : plans_) plan.paint(colour, ink(0xffffff));
}

void SceneSheet::line(const Vec3d& a, const Vec3d& b, double width, const Ink& c, double alpha) {
  camera_view_.line(scene_.frame.to_canonical(a), scene_.frame.to_canonical(b), width, c, alpha);
  for (Plan& plan : plans_) plan.line(a, b, width, c, alpha);
}

void SceneSheet::dot(const Vec3d& place, double radius, const Ink& c, double alpha) {
  camera_view_.dot_at(scene_.frame.to_canonical(place), radius, c, alpha);
  for (Plan& plan : plans_) plan.dot(place, radius, c, alpha);
}

Canvas SceneSheet::finish() {
  const Box& panel = camera_view_.projection().panel;
  canvas_.frame(panel, 1, kFaint);
  caption(
      canvas_, panel,
      camera_.name.empty() ? "The camera's view" : fmt::format("The view of '{}'", camera_.name));
  for (Plan& plan : plans_) {
    plan.camera(camera_);
    plan.finish();
  }
  return std::move(canvas_);
}

}  // namespace tdpt::draw
