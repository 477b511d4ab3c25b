#include "libcommon/draw/scene_sheet.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/math/rng.h"

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

size_t PatchLookup::Hash::operator()(const Key& k) const {
  uint64_t h = mix64(k.face + (static_cast<uint64_t>(k.level) << 40));
  for (const int32_t c : k.cell) h = mix64(h ^ static_cast<uint32_t>(c));
  return h;
}

PatchLookup::PatchLookup(const Frame& frame, const PatchGrid& grid,
                         const std::vector<Patch>& patches)
    : frame_(frame), grid_(grid) {
  for (size_t i = 0; i < patches.size(); ++i) {
    const Patch& p = patches[i];
    if (std::find(levels_.begin(), levels_.end(), p.level) == levels_.end())
      levels_.push_back(p.level);
    for (const uint32_t face : p.faces)
      patch_.emplace(Key{face, p.level, p.cell}, static_cast<uint32_t>(i));
  }
  std::sort(levels_.rbegin(), levels_.rend());
}

std::optional<uint32_t> PatchLookup::at(uint32_t face, const Vec3d& place) const {
  const Vec3d metres = frame_.to_metres(place);
  for (const int level : levels_) {
    // Uses the same operations as ffgraph, so that rounding at borders agrees.
    const Vec3d q = (metres - grid_.origin) / grid_.base_cell;
    const double fine = std::ldexp(1.0, 2 * level);
    Key key{face, level, {}};
    for (int c = 0; c < 3; ++c)
      key.cell[static_cast<size_t>(c)] =
          static_cast<int32_t>(std::clamp(std::floor(q[c] * fine), -2147483648.0, 2147483647.0));
    if (const auto found = patch_.find(key); found != patch_.end()) return found->second;
  }
  return {};
}

}  // namespace tdpt::draw
