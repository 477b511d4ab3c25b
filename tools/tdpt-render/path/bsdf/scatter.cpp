#include "tools/tdpt-render/path/bsdf/scatter.h"

// Flattened (inlined): each function then keeps only the part of the shared code that it needs.

namespace tdpt {

[[gnu::flatten]] Rgb layered_bsdf(const Point& p, Vec3d to_light, Vec3d to_camera) {
  return Rgb(surfaces().bsdf_at(p, to_light, to_camera));
}

double emission_under_coat(const Point& p, Vec3d w) {
  return surfaces().emission_under_coat(p, w);
}

[[gnu::flatten]] void Incidence::see_layers(const Point& p) {
  struct Made {  // converts to the context, so that emplace() builds it in place
    operator shader::Surfaces::ScatterContext() const {
      return surfaces().scatter_context_at(p, back);
    }
    const Point& p;
    const Vec3d& back;
  };
  layers.emplace(Made{p, back});
}

namespace {

uint32_t index(From from) {
  return from == From::camera ? shader::FROM_CAMERA : shader::FROM_LIGHT;
}

}  // namespace

bool turn(const Point& p, From from, const Incidence& in, const std::array<double, 3>& u,
          Turn& out) {
  if (p.simple) return surfaces().simple_turn(p, in.back, u[0], u[1], out);
  return surfaces().layered_turn(p, index(from), *in.layers, u[0], u[1], u[2], out);
}

bool turn_towards(const Point& p, From from, const Incidence& in, const Vec3d& w, Turn& out) {
  if (!p.simple) return surfaces().layered_turn_towards(p, index(from), *in.layers, w, out);
  out = {w, Vec3d(p.color), false};
  return same_side(p, in.back, w);
}

[[gnu::flatten]] double layered_pdf_w(const Point& p, const Incidence& in, const Vec3d& to,
                                      bool dirac) {
  return surfaces().layered_pdf_w(p, *in.layers, to, dirac);
}

[[gnu::flatten]] double layered_albedo(const Point& p, const Incidence& in) {
  return surfaces().layered_albedo(p, *in.layers, in.back);
}

Odds odds_at(const Point& p, const Incidence& in) {
  return p.simple ? Odds{0, 1} : surfaces().coated_odds(p, *in.layers);
}

Rgb albedo_of(const Point& p, const Incidence& in) {
  return Rgb(surfaces().coated_albedo(p, *in.layers));
}

Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d) {
  return Rgb(surfaces().transmittance(a, b, w, d));
}

}  // namespace tdpt
