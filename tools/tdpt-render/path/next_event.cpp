#include "tools/tdpt-render/path/next_event.h"

namespace tdpt {

Lights::Point NextEvents::sample(const Vertex& shaded, double through_windows, double pick,
                                 double u, double v, double side) const {
  if (!lights_.picks_sky(pick)) return lights_.sample(pick, u, v, side);
  const auto& [facing, seen] = shaded.outlook;
  const double q = seen > 0 ? through_windows : 0;
  const Vec3d towards = side < q ? windows_.sample(shaded.position, facing, seen, side / q, u, v)
                                 : lights_.directions().sample((side - q) / (1 - q), u, v);
  Lights::Point point;
  point.source = lights_.sky();
  point.position = -towards;
  point.in_sky = lights_.look(towards);
  point.pdf = pdf(shaded, *point.source, point.triangle, point.position, point.in_sky).of(q);
  return point;
}

NextEventPdf NextEvents::pdf(const Vertex& shaded, const LightSource& source, uint32_t triangle,
                             const Vec3d& position, const Lights::InSky& in_sky) const {
  if (!source.is_sky()) return {lights_.pdf(source, triangle, in_sky)};
  NextEventPdf pdf{source.pdf_1() * in_sky.plain_w};
  const auto& [facing, seen] = shaded.outlook;
  pdf.sees_windows = seen > 0;
  if (pdf.sees_windows)
    pdf.windows = source.pdf_1() * windows_.pdf_w(shaded.position, facing, seen, -position);
  return pdf;
}

}  // namespace tdpt
