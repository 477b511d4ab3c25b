#include "tools/tdpt-render/path/light/next_event.h"

#include "shaders/shared/path/point.h"
#include "shaders/shared/warp.h"

namespace tdpt::shader {
namespace {

// The text in doubles.
struct Panels {
  using Real = double;
  using Point = tdpt::Point;
  using Outlook = tdpt::Outlook;
  using Panel = tdpt::Panel;
  using LightPlace = Lights::Point;

  explicit Panels(const std::vector<Panel>& all)
      : all_(all.data()), light_settings{static_cast<uint>(all.size())} {}
  const Panel& load_light_panel(uint i) const { return all_[i]; }
  static bool is_two_sided(const LightSource* source) { return source->both_sides(); }
  static LightPlace no_light_place() { return {}; }

 private:
  const Panel* all_;
  struct {
    uint panels;
  } light_settings;

 public:
#include "shaders/shared/path/panels.h"
};

}  // namespace
}  // namespace tdpt::shader

namespace tdpt {

[[gnu::flatten]] double NextEvents::sent_by_panels(const Vertex& v) const {
  return shader::Panels(panels_).sent_by_panels(v, v.outlook.facing);
}

// As the text's place_on_panels(), which looks at each again.
[[gnu::flatten]] Lights::Point NextEvents::sample_panels(Vertex& v, double pick, double a,
                                                         double b) const {
  const shader::Panels text(panels_);
  const Vec3d up = text.panel_horizon(v, v.outlook.facing);
  const bool both_ways = shader::is_zero(v.outlook.facing);
  std::array<shader::Panels::PanelView, kMostPanels> views;
  double& sent = v.outlook.sent;
  sent = 0;
  for (size_t i = 0; i < panels_.size(); ++i) {
    views[i] = text.look_at_panel(panels_[i], v.position, up, both_ways);
    sent += panels_[i].weight * views[i].total;
  }
  double left = pick * sent;
  size_t chosen = panels_.size();
  for (size_t i = 0; i < panels_.size() && left >= 0; ++i) {
    const double share = panels_[i].weight * views[i].total;
    if (!(share > 0)) continue;
    chosen = i;
    left = left < share ? -1 : left - share;
  }
  if (chosen == panels_.size()) return {};
  return text.place_on_panel(panels_[chosen], views[chosen], sent, a, b);
}

Lights::Point NextEvents::sample(Vertex& shaded, double through_windows, double pick, double u,
                                 double v, double side) const {
  if (const double share = lights_.shares().surfaces; by_panels() && pick < share) {
    Lights::Point point = sample_panels(shaded, pick / share, u, v);
    point.pdf *= share;
    return point;
  }
  if (!lights_.picks_sky(pick)) return lights_.sample(pick, u, v, side);
  const auto& [facing, seen, sent] = shaded.outlook;
  const double q = seen > 0 ? through_windows : 0;
  // What is below the horizon is as good as black: it is not looked at.
  const auto above = [&facing = facing](const Vec3d& towards) {
    return facing == Vec3d() || dot(facing, towards) > 0;
  };
  Lights::Point point;
  point.source = lights_.sky();
  if (side < q) {
    const Vec3d towards = windows_.sample(shaded.position, facing, seen, side / q, u, v);
    point.position = -towards;
    if (above(towards)) point.in_sky = lights_.look(towards);
  } else {
    const Sky::Place place = lights_.directions().draw((side - q) / (1 - q), u, v);
    point.position = -place.towards;
    if (above(place.towards)) point.in_sky = lights_.look(place);
  }
  return point;
}

NextEventPdf NextEvents::pdf(const Vertex& shaded, const LightSource& source, uint32_t triangle,
                             const Vec3d& position, const Lights::InSky& in_sky) const {
  if (by_panels() && source.is_surface()) {
    Outlook outlook = shaded.outlook;
    if (outlook.sent < 0) outlook.sent = sent_by_panels(shaded);
    return {lights_.shares().surfaces *
            shader::Panels(panels_).pdf_A_by_panels(shaded, outlook, triangle, position)};
  }
  if (!source.is_sky()) return {lights_.pdf(source, triangle, position, in_sky)};
  NextEventPdf pdf{source.pdf_1() * in_sky.plain_w};
  const auto& [facing, seen, sent] = shaded.outlook;
  pdf.sees_windows = seen > 0;
  if (pdf.sees_windows)
    pdf.windows = source.pdf_1() * windows_.pdf_w(shaded.position, facing, seen, -position);
  return pdf;
}

}  // namespace tdpt
