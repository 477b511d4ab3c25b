// A vertex of a path, and the scattering at it.
//
// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// kept in the order they were walked: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.
// Densities are per canonical area (pdf_A) unless their name says otherwise.
//
// The radiance BSDF is taken with geometric cosines everywhere: where the shading normal ns differs
// from the geometric normal ng, f(to_light, to_camera) carries |to_light.ns| / |to_light.ng| (Veach
// 5.3), and a direction that lies above one of them and below the other is dark. So walks from
// either side agree.
#pragma once
#include <array>
#include <numbers>

#include "libcommon/scene/lights.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/path/bsdf.h"
#include "tools/tdpt-render/portals.h"

namespace tdpt {

enum class From { light, camera };

/// How a walk is directed at the portals where it stands (guide.h).
struct Aim {
  double chance = 0;      ///< that it is
  double per_weight = 0;  ///< chance / W
};

struct Vertex {
  Vec3d position{};  ///< of no meaning at infinity
  Vec3d normal{};    ///< unit geometric normal of the front side; 0 off surfaces (camera, lamps)
  const Material* material = nullptr;
  const Lamp* lamp = nullptr;  ///< punctual light
  uint32_t triangle = ~0u;

  /// Diffuse reflection about the geometric normal by material->base_color, emission
  /// material->emission. Otherwise `shading`, `bsdf` and `emission` hold what is there.
  bool simple = true;
  bool connectible = true;  ///< some lobe is not Dirac
  bool dirac = false;       ///< its walk went on by a Dirac lobe
  Vec3d shading{};          ///< unit shading normal, front side
  Bsdf bsdf;
  Rgb emission{};

  // Of the walk that made the vertex.
  Rgb throughput{};        ///< product of f cos / pdf_w up to here, without the scattering here
  double pdf_own_A = 0;    ///< sampled by its own walk
  double pdf_other_A = 0;  ///< as the other walk would sample it; known two vertices later
  PortalSet::Crossing crossing{};  ///< of the edge to the previous vertex (portals.h)

  // Of walks that may be directed at portals (guide.h).
  Vec3d facing{};          ///< side of the surface that its edges are on; 0: both
  std::array<Aim, 2> aim;  ///< of a walk from the light, from the camera, that scatters here
  Aim lamp_aim;            ///< of a walk that begins here

  bool on_surface() const { return material != nullptr; }
  bool at_infinity() const { return lamp && lamp->directional(); }
  /// |cos| to the surface; 1 where there is none.
  double cosine(const Vec3d& w) const { return on_surface() ? std::abs(dot(normal, w)) : 1; }
  Tracer::Origin origin() const { return {position, normal}; }
};

/// The way from one vertex to another.
struct Edge {
  Vec3d w;    ///< unit
  double d2;  ///< squared distance; 1 when one end is infinitely far
};
inline Edge between(const Vertex& a, const Vertex& b) {
  if (a.at_infinity()) return {a.lamp->light.direction, 1};
  if (b.at_infinity()) return {-b.lamp->light.direction, 1};
  const Vec3d d = b.position - a.position;
  const double d2 = dot(d, d);
  return {d / std::sqrt(d2), d2};
}

/// G without visibility [1/m2]: |cos_a cos_b| / d^2.
inline double geometry(const Vertex& a, const Vertex& b, const Edge& e) {
  return a.cosine(e.w) * b.cosine(e.w) / e.d2;
}

/// Density of arriving at `to` per area along `e` when it was left with density pdf_w:
/// pdf_A = pdf_w |cos_to| / d^2.
inline double to_area(double pdf_w, const Edge& e, const Vertex& to) {
  return pdf_w * to.cosine(e.w) / e.d2;
}

/// Both directions on the same side of the surface at `v`.
inline bool same_side(const Vertex& v, const Vec3d& wi, const Vec3d& wo) {
  return dot(v.normal, wi) * dot(v.normal, wo) > 0;
}

// Of vertices that are not simple.
Rgb layered_bsdf(const Vertex& v, const Vec3d& to_light, const Vec3d& to_camera);
double layered_scatter_pdf_A(const Vertex& from, const Vertex& at, const Vertex& to, bool dirac);

/// Radiance BSDF without Dirac lobes [1/sr]; unit directions away from the surface.
inline Rgb bsdf_at(const Vertex& v, const Vec3d& to_light, const Vec3d& to_camera) {
  if (!v.simple) return layered_bsdf(v, to_light, to_camera);
  return same_side(v, to_light, to_camera)
             ? v.material->base_color * static_cast<float>(std::numbers::inv_pi)
             : Rgb{};
}

/// pdf_A of reaching `to` when the walk came from `from` and scatters at `at`. `dirac`: by a Dirac
/// lobe; its density is per n^2 |cos| dw, which reflection and refraction preserve.
inline double scatter_pdf_A(const Vertex& from, const Vertex& at, const Vertex& to, bool dirac) {
  if (!at.simple) return layered_scatter_pdf_A(from, at, to, dirac);
  const Edge e = between(at, to);
  const double cos_in =
      dot(at.normal, from.at_infinity() ? between(at, from).w : from.position - at.position);
  const double cos_out = dot(at.normal, e.w);
  if (!(cos_in * cos_out > 0)) return 0;
  return to_area(std::abs(cos_out) * std::numbers::inv_pi, e, to);
}

/// Whether any light leaves it.
inline bool emits(const Vertex& v) {
  const Rgb& e = v.simple && v.material ? v.material->emission : v.emission;
  return v.lamp || e.x > 0 || e.y > 0 || e.z > 0;
}

/// Radiance that a light vertex sends along unit w; of lamps intensity (Lamp).
inline Rgb emitted(const Vertex& v, const Vec3d& w) {
  if (v.lamp) return v.lamp->intensity(w);
  return emitted_radiance(*v.material, v.simple ? v.material->emission : v.emission, v.normal, w);
}

/// pdf_A of reaching `to` when light leaves `light`.
inline double emission_pdf_A(const Vertex& light, const Vertex& to) {
  const Edge e = between(light, to);
  return to_area(light.lamp ? light.lamp->pdf_towards(e.w)
                            : emission_pdf_w(*light.material, dot(light.normal, e.w)),
                 e, to);
}

}  // namespace tdpt
