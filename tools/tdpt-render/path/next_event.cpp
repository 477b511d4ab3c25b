#include "tools/tdpt-render/path/next_event.h"

namespace tdpt {

Lights::Point NextEvents::sample(const Vertex& shaded, double pick, double u, double v,
                                 double side) const {
  if (!lights_.picks_sky(pick)) return lights_.sample(pick, u, v, side);
  const auto& [facing, seen] = shaded.outlook;
  const double q = seen > 0 ? through_windows_ : 0;
  const Vec3d towards = side < q ? windows_.sample(shaded.position, facing, seen, side / q, u, v)
                                 : lights_.directions().sample((side - q) / (1 - q), u, v);
  Lights::Point point;
  point.source = lights_.sky();
  point.position = -towards;
  point.pdf = pdf(shaded, *point.source, point.triangle, point.position);
  return point;
}

double NextEvents::pdf(const Vertex& shaded, const LightSource& source, uint32_t triangle,
                       const Vec3d& position) const {
  if (!source.is_sky()) return lights_.pdf(source, triangle, position);
  const double plain = lights_.directions().pdf_w(-position);
  const auto& [facing, seen] = shaded.outlook;
  if (!(seen > 0)) return source.pdf_1() * plain;
  const double q = through_windows_;
  const double through = windows_.pdf_w(shaded.position, facing, seen, -position);
  return source.pdf_1() * ((1 - q) * plain + q * through);
}

}  // namespace tdpt
