#include "tools/tdpt-render/path/bsdf/scatter.h"

#include "tools/tdpt-render/path/bsdf/surfaces.h"

// Flat: of each text what its answer does not need is left out.

namespace tdpt {

[[gnu::flatten]] Rgb layered_bsdf(const Point& p, Vec3d to_light, Vec3d to_camera) {
  return Rgb(surfaces().bsdf_at(p, to_light, to_camera));
}

[[gnu::flatten]] double layered_scatter_pdf_w(const Point& at, Vec3d back, Vec3d to, bool dirac) {
  return surfaces().scatter_pdf_w(at, back, to, dirac);
}

double emission_under_coat(const Point& p, Vec3d w) {
  return surfaces().emission_under_coat(p, w);
}

double layered_albedo(const Point& p, Vec3d back) {
  return surfaces().albedo_at(p, back);
}

namespace {

uint32_t index(From from) {
  return from == From::camera ? shader::FROM_CAMERA : shader::FROM_LIGHT;
}

}  // namespace

bool turn(const Point& p, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out) {
  return surfaces().turn(p, index(from), back, u[0], u[1], u[2], out);
}

bool turn_towards(const Point& p, From from, const Vec3d& back, const Vec3d& w, Turn& out) {
  return surfaces().turn_towards(p, index(from), back, w, out);
}

Odds odds_of(const Point& p, const Vec3d& back) {
  return surfaces().odds_at(p, back);
}

Rgb albedo_of(const Point& p, const Vec3d& back) {
  return Rgb(surfaces().coated_albedo(p, surfaces().standing_at(p, back)));
}

Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d) {
  return Rgb(surfaces().transmittance(a, b, w, d));
}

}  // namespace tdpt
