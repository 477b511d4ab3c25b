#include "tools/portalfit/plan_preview.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/draw/plan.h"
#include "libcommon/draw/sheet.h"
#include "tools/portalfit/preview.h"

namespace tdpt {
namespace {

using namespace draw;

constexpr double kTallest = 1040, kNarrowest = 430, kReasonRow = 20;
constexpr size_t kMostReasons = 8;

Vec3d middle_of(const std::vector<Vec3d>& corners) {
  Vec3d sum{};
  for (const Vec3d& p : corners) sum = sum + p;
  return sum / static_cast<double>(std::max<size_t>(corners.size(), 1));
}

Opening opening_of(const Portal& portal) {
  Opening o{portal.vertices, {}, "", false};  // portalfit's vertices are its outline
  o.way = frame_of(portal).n;
  return o;
}

// What was found and refused, and the reasons of the refused.
struct Shown {
  std::vector<Opening> openings;
  std::vector<Vec3d> places;  // of the portals
  std::vector<std::string> reasons;
  size_t not_drawn = 0;
};

// In the words of a list: each entry has the candidate's letter before it.
std::string without_subject(const std::string& why) {
  constexpr std::string_view kOne = "a candidate ", kOfSize = "a candidate of ",
                             kNumbered = "1 candidate ";
  if (why.starts_with(kOfSize)) {
    const size_t unit = why.find(" m2 ");
    if (unit != std::string::npos)
      return why.substr(kOfSize.size(), unit + 3 - kOfSize.size()) + ", " + why.substr(unit + 4);
  }
  for (const std::string_view one : {kOne, kNumbered})
    if (why.starts_with(one)) return why.substr(one.size());
  return why;
}

// One reason, of one candidate or of several.
void add_grey(Shown& shown, const std::vector<std::vector<Vec3d>>& polygons,
              const std::string& why) {
  if (shown.reasons.size() == kMostReasons) {
    ++shown.not_drawn;
    return;
  }
  const std::string letter(1, static_cast<char>('A' + shown.reasons.size()));
  shown.reasons.push_back(fmt::format("{}: {}", letter, without_subject(why)));
  for (const auto& p : polygons)
    if (p.size() > 2)
      shown.openings.push_back({p, normalize(cross(p[1] - p[0], p[2] - p[0])), letter, true});
}

Shown shown_of(const FitResult& found) {
  Shown shown;
  for (const Portal& portal : found.portals) {
    Opening o = opening_of(portal);
    o.label = fmt::format("portal.{}", shown.places.size());
    if (std::abs(o.way.y) > 0.7) o.label += o.way.y > 0 ? ", up" : ", down";
    shown.openings.push_back(std::move(o));
    shown.places.push_back(middle_of(portal.vertices));
  }
  for (const FitResult::Refusal& r : found.refused)
    if (!r.polygons.empty()) add_grey(shown, r.polygons, r.why);
  return shown;
}

// All plans of one size, as large as they can be, in rows.
std::vector<Box> panels_of(size_t plans, double aspect) {
  double width = 0, height = 0;
  size_t columns = 1;
  for (size_t c = 1; c <= plans; ++c) {
    const size_t rows = (plans + c - 1) / c;
    const double cell = (kSheetWidth - kMargin) / static_cast<double>(c) - kMargin,
                 room = kTallest / static_cast<double>(rows) - Plan::kCaptionRoom,
                 h = std::floor(std::min(room, cell / aspect));
    if (h * aspect <= height * aspect) continue;
    height = h, width = std::floor(std::min(cell, std::max(1.25 * h * aspect, kNarrowest)));
    columns = c;
  }
  std::vector<Box> panels;
  for (size_t k = 0; k < plans; ++k)
    panels.push_back({kMargin + static_cast<double>(k % columns) * (width + kMargin),
                      kHeading + static_cast<double>(k / columns) * (height + Plan::kCaptionRoom),
                      width, height});
  return panels;
}

std::string sentence_of(const Shown& shown, size_t portals, const std::string& why_none) {
  if (portals == 0) return "no portal: " + why_none;
  return fmt::format("{} portal{}{}", portals, portals == 1 ? "" : "s",
                     shown.reasons.empty() ? "" : "; grey: what was refused, by the letters below");
}

bool has_lamps(const Scene& scene) {
  return std::any_of(
             scene.lights.begin(), scene.lights.end(),
             [](const PunctualLight& l) { return l.kind != PunctualLight::Kind::directional; }) ||
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return max_component(m.emission) > 0; });
}

}  // namespace

draw::Canvas plan_preview(const Scene& scene, const Camera& camera, const FitResult& found,
                          const std::string& why_none) {
  const Shown shown = shown_of(found);
  const Tracer tracer(scene);
  const Vec3d eye = scene.frame.to_metres(camera.position);
  std::vector<Storey> storeys = storeys_to_draw(scene, tracer, eye, shown.places);
  std::sort(storeys.begin(), storeys.end(),
            [](const Storey& a, const Storey& b) { return a.cut < b.cut; });
  std::vector<Vec3d> places = shown.places;
  places.push_back(eye);
  const Extent extent = extent_of(storeys, places);
  const std::vector<Box> panels = panels_of(storeys.size(), std::clamp(extent.aspect(), 0.4, 4.0));
  const double legend = panels.back().bottom() + Plan::kCaptionRoom + 26;
  const size_t rows = shown.reasons.size() + (shown.not_drawn > 0);
  Canvas canvas(kSheetWidth,
                static_cast<int>(legend + kMargin + kReasonRow * static_cast<double>(rows)),
                kPaper);
  heading(canvas, "portalfit   " + base_name(scene.path),
          sentence_of(shown, shown.places.size(), why_none));
  for (size_t k = 0; k < storeys.size(); ++k) {
    Plan plan(canvas, scene, tracer, storeys[k], extent, panels[k]);
    plan.paint([](uint32_t, const Vec3d&) { return kPaper; }, ink(0xffffff));
    plan.openings(shown.openings);
    plan.camera(camera);
    plan.finish();
  }
  std::vector<std::pair<Ink, std::string>> entries{
      {kPortal, "portal; the arrow is the way of the light"},
      {kCutCamera, "camera and its view"},
      {kCutWall, "cut at eye height"},
      {kCutGlass, "pane"},
  };
  if (has_lamps(scene)) entries.emplace_back(kLamp, "lamps");
  if (!shown.reasons.empty()) entries.emplace_back(kRefused, "refused");
  key(canvas, {kMargin, legend}, entries);
  double y = legend + kReasonRow + 8;
  for (const std::string& why : shown.reasons) {
    canvas.text({kMargin, y}, why,
                {.size = kSmallSize, .ink = kMuted, .room = kSheetWidth - 2 * kMargin});
    y += kReasonRow;
  }
  if (shown.not_drawn > 0)
    canvas.text({kMargin, y}, fmt::format("{} more are not drawn", shown.not_drawn),
                {kSmallSize, kMuted});
  return canvas;
}

}  // namespace tdpt
