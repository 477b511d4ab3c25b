#include "tools/tdpt-render/path/sample/connect.h"

#include "tools/tdpt-render/path/sample/surface.h"

namespace tdpt {
namespace {

// What `end` carries and scatters, or emits, along unit w.
Rgb towards(const End& end, const Vec3d& w, From from) {
  if (!end.layered) return end.carried;
  if (end.back == Vec3d()) return end.carried * emitted(*end.vertex, w);
  return end.carried * (from == From::light ? bsdf_at(*end.vertex, end.back, w)
                                            : bsdf_at(*end.vertex, w, end.back));
}

}  // namespace

Rgb connect_layered(const World& world, const End& l, const End& c) {
  const Edge e = between(*l.vertex, *c.vertex);
  const Rgb sent = towards(l, e.w, From::light);
  if (sent == Rgb{}) return {};
  const Rgb value =
      sent * towards(c, -e.w, From::camera) * static_cast<float>(geometry(*l.vertex, *c.vertex, e));
  return world.absorbing ? value * transmittance(*l.vertex, *c.vertex, e.w, std::sqrt(e.d2))
                         : value;
}

}  // namespace tdpt
