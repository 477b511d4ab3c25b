// A vertex of a path as a surface or light point, with the light emitted and scattered there.
//
// Densities are per canonical area (pdf_A) unless their name says otherwise.
#pragma once
#include <numbers>

#include "libcommon/scene/lights.h"
#include "libcommon/trace/tracer.h"
#include "shaders/shared/path/point.h"

namespace tdpt {

using shader::Bsdf;
using Odds = shader::Odds<double>;
using Turn = shader::Turn<double>;

enum class From : uint32_t { light = shader::FROM_LIGHT, camera = shader::FROM_CAMERA };

struct Point {
  Vec3d position{};  ///< at infinity: the unit direction in which the light travels
  Vec3d normal{};    ///< unit geometric normal of the front side; 0 if not on a surface
  const Material* material = nullptr;   ///< of a surface; null elsewhere
  const LightSource* source = nullptr;  ///< the light that begins here, if any
  uint32_t triangle = ~0u;

  /// The surface is only diffuse: it reflects `color` about the geometric normal. Otherwise
  /// `shading` and `bsdf` hold what is there.
  bool simple = true;
  bool connectible = true;  ///< some lobe is not Dirac
  Rgb color{};
  Rgb emission{};          ///< of a surface that emits [W/m2/sr]
  Lights::InSky in_sky{};  ///< of a point in the sky
  Vec3d shading{};         ///< unit shading normal of the front side
  Bsdf bsdf{};

  bool on_surface() const { return material != nullptr; }
  bool at_infinity() const { return source && source->at_infinity(); }
  /// Whether a ray can hit it: true except for lights without surface.
  bool met() const { return !source || source->met(); }
  /// |cos| to the surface; 1 if not on a surface.
  double cosine(const Vec3d& w) const { return on_surface() ? std::abs(dot(normal, w)) : 1; }
  Tracer::Origin origin() const { return {position, normal, triangle}; }
};

/// The connection from one point to another.
struct Edge {
  Vec3d w;    ///< unit
  double d2;  ///< squared distance; 1 if one end is infinitely far
};
/// The same edge from the other end.
inline Edge reversed(const Edge& e) {
  return {-e.w, e.d2};
}
inline Edge between(const Point& a, const Point& b) {
  if (a.at_infinity()) return {a.position, 1};
  if (b.at_infinity()) return {-b.position, 1};
  const Vec3d d = b.position - a.position;
  const double d2 = dot(d, d);
  return {d / std::sqrt(d2), d2};
}

/// A point on the line of light through `p` along unit w that lies before all of the scene's frame,
/// which is within 2 of the origin (canonical), or `distance` before the origin; never behind p.
inline Vec3d before_the_scene(const Vec3d& p, const Vec3d& w,
                              double distance = shader::kBeforeTheScene) {
  return p - w * std::max(dot(p, w) + distance, 1.0);
}

/// G without visibility [1/m2]: |cos_a cos_b| / d^2.
inline double geometry(const Point& a, const Point& b, const Edge& e) {
  return a.cosine(e.w) * b.cosine(e.w) / e.d2;
}

/// Converts the density pdf_w of leaving along `e` to that of arriving at `to`: pdf_A = pdf_w
/// |cos_to| / d^2.
inline double to_area(double pdf_w, const Edge& e, const Point& to) {
  return pdf_w * to.cosine(e.w) / e.d2;
}

/// Whether both directions are on the same side of the surface at `p`.
inline bool same_side(const Point& p, const Vec3d& wi, const Vec3d& wo) {
  return dot(p.normal, wi) * dot(p.normal, wo) > 0;
}

// For points that are not simple [scatter.cpp]. Passed by value: an address would keep the vectors
// of simple points out of registers.
Rgb layered_bsdf(const Point& p, Vec3d to_light, Vec3d to_camera);
/// Share of the emission along w that passes the clear coat.
double emission_under_coat(const Point& p, Vec3d w);

/// Normal on the side of the surface at `p` that holds all edges of a path with one along `away`; 0
/// if light passes through, so that both sides count.
inline Vec3d facing(const Point& p, const Vec3d& away) {
  if (!p.simple && shader::is_positive(p.bsdf.through)) return {};
  return dot(p.normal, away) > 0 ? p.normal : -p.normal;
}

/// Radiance BSDF without Dirac lobes [1/sr]; unit directions point away from the surface.
inline Rgb bsdf_at(const Point& p, const Vec3d& to_light, const Vec3d& to_camera) {
  if (!p.simple) return layered_bsdf(p, to_light, to_camera);
  return same_side(p, to_light, to_camera) ? p.color * static_cast<float>(std::numbers::inv_pi)
                                           : Rgb{};
}

/// Emission along unit w (LightSource; at infinity w is the position); black if no light begins
/// here.
inline Rgb emitted(const Point& p, const Vec3d& w) {
  if (!p.source) return {};
  if (p.source->is_sky()) return p.in_sky.radiance;
  const Rgb out = p.source->emitted(p.normal, p.emission, w);
  if (p.simple || !(p.bsdf.coat.strength > 0)) [[likely]]
    return out;
  return out * static_cast<float>(emission_under_coat(p, w));
}

/// pdf_A with which light emitted at `light` reaches `to` along `e`.
inline double emission_pdf_A(const Point& light, const Edge& e, const Point& to) {
  return to_area(light.source->pdf_w(light.normal, e.w), e, to);
}

// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// stored in walking order: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.

/// Normalisation W of the guiding distribution at a point [portals.h]; 0 if no portal can be aimed
/// at from there (Guide).
struct GuideTotals {
  Vec3d facing{};  ///< normal on the side of the surface that the path's edges are on; 0: both
                   ///< sides
  double from_light = 0, from_camera = 0;  ///< for walks from that end that scatter here
  double emitted = 0;                      ///< for a walk that begins here
  double of(From from) const { return from == From::light ? from_light : from_camera; }
};

/// What next events know about a point [next_event.h].
struct LightContext {
  Vec3d facing{};   ///< normal on the side of the surface that light arrives at; 0: both sides
  double seen = 0;  ///< sum S_F over the windows through which it sees the sky [window_sky.h]
  double sent = 0;  ///< by the rectangular lights [next_event.h]; negative: not yet evaluated
};

struct Vertex : Point {
  GuideTotals guide_totals;
  LightContext light_context;  ///< set for vertices at which next events may be made
};

}  // namespace tdpt
