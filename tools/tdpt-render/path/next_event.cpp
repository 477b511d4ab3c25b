#include "tools/tdpt-render/path/next_event.h"

namespace tdpt {

Lights::Point NextEvents::sample(const Vec3d& shaded, double pick, double u, double v,
                                 double side) const {
  if (!lights_.picks_sky(pick)) return lights_.sample(pick, u, v, side);
  Lights::Point point;
  const double seen = windows_.seen(shaded);
  const double q = seen > 0 ? through_windows_ : 0;
  const Vec3d towards = side < q ? windows_.sample(shaded, seen, side / q, u, v)
                                 : lights_.directions().sample((side - q) / (1 - q), u, v);
  point.source = lights_.sky();
  point.position = -towards;
  point.pdf = pdf(shaded, *point.source, ~0u, point.position);
  return point;
}

double NextEvents::pdf(const Vec3d& shaded, const LightSource& source, uint32_t triangle,
                       const Vec3d& position) const {
  if (!source.is_sky()) return lights_.pdf(source, triangle, position);
  const double seen = windows_.seen(shaded);
  const double plain = lights_.directions().pdf_w(-position);
  if (!(seen > 0)) return source.pdf_1() * plain;
  const double q = through_windows_;
  return source.pdf_1() * ((1 - q) * plain + q * windows_.pdf_w(shaded, seen, -position));
}

}  // namespace tdpt
