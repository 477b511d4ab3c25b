#include "tools/tdpt-render/path/light/next_event.h"

namespace tdpt {

Lights::Point NextEvents::sample(Vertex& shaded, double through_windows, double pick, double u,
                                 double v, double side) const {
  if (const double share = lights_.shares().surfaces; by_panels() && pick < share) {
    Lights::Point point;
    if (!panels_.sample(shaded, pick / share, u, v, shaded.outlook.sent, point)) return point;
    point.pdf *= share;
    point.source = &lights_.surface(panels_.both_sides(point.triangle));
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
    const double told = shaded.outlook.sent;
    const double sent = told < 0 ? panels_.sent(shaded) : told;
    return {lights_.shares().surfaces * panels_.pdf_A(shaded, sent, triangle, position)};
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
