// A vertex of a path, and the scattering at it.
//
// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// kept in the order they were walked: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.
// Densities are per canonical area (pdf_A) unless their name says otherwise.
#pragma once
#include <numbers>
#include <vector>

#include "libcommon/scene/emitters.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct Vertex {
  Vec3d position;
  Vec3d normal{};  ///< unit geometric normal of the front side; 0 at the camera
  const Material* material = nullptr;
  uint32_t triangle = ~0u;

  // Of the walk that made the vertex.
  Rgb throughput{};           ///< product of f cos / pdf_w up to here, without the scattering here
  double pdf_own_A = 0;       ///< sampled by its own walk
  double pdf_other_A = 0;     ///< as the other walk would sample it; known two vertices later
  double portal_density = 0;  ///< D of the edge to the previous vertex (portals.h)

  Tracer::Origin origin() const { return {position, normal}; }
};

/// Density of arriving at `to` per area when leaving `at` has density pdf_w:
/// pdf_A = pdf_w |cos_to| / d^2.
inline double to_area(double pdf_w, const Vec3d& w, double d2, const Vec3d& normal_to) {
  return pdf_w * std::abs(dot(normal_to, w)) / d2;
}

/// Both places on the same side of the surface at `v`.
inline bool same_side(const Vertex& v, const Vec3d& wi, const Vec3d& wo) {
  return dot(v.normal, wi) * dot(v.normal, wo) > 0;
}

/// Diffuse BSDF [1/sr]; wi, wo unit, away from the surface.
inline Rgb bsdf(const Vertex& v, const Vec3d& wi, const Vec3d& wo) {
  return same_side(v, wi, wo) ? v.material->base_color * static_cast<float>(std::numbers::inv_pi)
                              : Rgb{};
}

/// pdf_A of reaching `to` when the walk came from `from` and scatters at `at`: cos-distributed on
/// the side it came from.
inline double scatter_pdf_A(const Vertex& from, const Vertex& at, const Vertex& to) {
  const Vec3d d = to.position - at.position;
  const double d2 = dot(d, d);
  const Vec3d w = d / std::sqrt(d2);
  const double cos_in = dot(at.normal, from.position - at.position);
  const double cos_out = dot(at.normal, w);
  if (!(cos_in * cos_out > 0)) return 0;
  return to_area(std::abs(cos_out) * std::numbers::inv_pi, w, d2, to.normal);
}

/// pdf_A of reaching `to` when light leaves `light`.
inline double emission_pdf_A(const Vertex& light, const Vertex& to) {
  const Vec3d d = to.position - light.position;
  const double d2 = dot(d, d);
  const Vec3d w = d / std::sqrt(d2);
  return to_area(emission_pdf_w(*light.material, dot(light.normal, w)), w, d2, to.normal);
}

}  // namespace tdpt
