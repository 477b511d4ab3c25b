// Ray queries: the closest hit, and mutual visibility of two points, in the canonical frame.
//
// Method: ray casting with a bounding volume hierarchy (Embree, which stays behind this header), in
// floats; hit points are recomputed from barycentrics in double precision. They stay where they
// are, except next to an edge of their triangle: there the ray is looked at again, since rounding
// may have let it pass the neighbour, and the hit moves off the edge [shaders/shared/bvh.h].
//
// Self-intersection: rays start exactly on surfaces, so their origins are offset by a few units in
// the last place of the coordinates, of the triangle's corners too where a scene reaches far beyond
// its frame: along the geometric normal to the side that the ray leaves on, or along the ray if the
// origin is in the air (even there a lamp or camera may lie in a surface).
//
// Stochastic transparency: surfaces that are not opaque (alpha) and window panes (scene.h) have a
// `coverage` at each point and stop that share of the rays, selected by a hash of the exact point.
// So three of ten rays hit a blend of 0.3, and no ray needs random numbers of its own. A pane's
// coverage is its reflectance; the rest is transmitted.
//
// Culling: camera rays and rays to the camera may pass the backs of single-sided surfaces. The side
// that is hit depends on the ray alone, so that is a coverage of 0 or 1.
#pragma once
#include <memory>

#include "libcommon/scene/scene.h"

namespace tdpt {

namespace shader {
struct SurfaceHit;  // shaders/shared/bvh.h
}

struct Hit {
  uint32_t triangle = ~0u;
  double b1, b2;    ///< barycentrics of vertices 1 and 2
  double distance;  ///< from the exact origin to the exact hit point
  Vec3d position;   ///< p0 + b1 e1 + b2 e2
  Vec3d normal;     ///< unit geometric normal of the front side (counter-clockwise)
  /// Coverage of a pane: probability that it stops a ray at this angle; divide its scattering by
  /// it. 1 for everything else: a blend scatters its alpha's share, so the two cancel.
  double opacity = 1;
};

class Tracer {
 public:
  /// Builds the hierarchy; keeps a reference to `scene`. `culls`: of cameras [Camera::culls].
  explicit Tracer(const Scene& scene, bool culls = false);
  ~Tracer();
  bool culls() const { return culls_; }
  /// Largest absolute coordinate of a triangle: 1 at most, unless the scene reaches far beyond its
  /// frame.
  double reach() const;

  /// Origin of rays. `normal` (unit, either side) is the direction of the offset from the surface;
  /// zero in the air (camera, lamp, portal). `triangle`: that it lies on, if known.
  struct Origin {
    Vec3d position;
    Vec3d normal{};
    uint32_t triangle = ~0u;
  };

  /// First surface along unit direction `w`; false if there is none. Also false if the hit is at
  /// `from` itself, because the ray did not leave the surface, or if a neighbour stopped the ray
  /// before; then `hit` has its triangle.
  bool closest(const Origin& from, const Vec3d& w, Hit& hit) const;

  /// The same without an offset: rays both ways along a line from one point hit each surface once
  /// and miss none.
  bool closest_from(const Vec3f& from, const Vec3d& w, Hit& hit) const;

  /// Whether nothing lies between two points, both offset from their own surfaces.
  bool visible(const Origin& a, const Origin& b) const;

  /// The same for a camera at that point.
  bool first_seen(const Vec3d& camera, const Vec3d& w, Hit& hit) const;
  bool sees(const Vec3d& camera, const Origin& place) const;
  /// The same two for the first surface of any coverage above 0, except those that `passed` names.
  struct Sheet {
    Hit hit;
    double coverage;  ///< share of the rays that it stops
  };
  bool first_sheet(const Origin& from, const Vec3d& w, const std::vector<uint32_t>& passed,
                   Sheet& sheet) const;
  bool first_sheet_seen(const Vec3d& camera, const Vec3d& w, const std::vector<uint32_t>& passed,
                        Sheet& sheet) const;
  /// Whether a camera looking along `w`, of any length, sees the side of the triangle that faces
  /// it.
  bool draws(uint32_t triangle, const Vec3d& w) const {
    return !culls_ || dot(shape(triangle).normal, w) <= 0 || !scene_.single_sided(triangle);
  }

  /// For kernels that compute in floats and offset origins themselves: first surface beyond `from`
  /// along `w`, of any length. `coin`, random bits of the ray, decides together with those of the
  /// triangle whether a surface that is not opaque stops the ray (surface_stops() of
  /// shaders/shared/coverage.h).
  bool first_hit(const Vec3f& from, const Vec3f& w, uint32_t coin, shader::SurfaceHit& hit) const;
  /// Whether something lies between `a` and `b`; in floats, as above.
  bool segment_blocked(const Vec3f& a, const Vec3f& b, uint32_t coin) const;

  /// Geometry of a triangle, computed once.
  const TriangleShape& shape(uint32_t triangle) const;

 private:
  friend struct TracerFaults;  // of tests [libcommon/testing/tracer_faults.h]

  Vec3f step_off(const Origin& from, const Vec3d& w) const;
  Vec3f step_off_afar(const Origin& from, const Vec3d& w) const;
  struct Query;
  struct CameraQuery;
  bool stopped_before(Query& query, const Vec3f& o, const Vec3d& w, const Origin& at) const;
  bool first_surface(Query& query, const Vec3f& o, const Vec3d& from, const Vec3d& w,
                     Hit& hit) const;
  bool first_sheet(Query& query, const Origin& from, const Vec3d& w,
                   const std::vector<uint32_t>& passed, Sheet& sheet) const;
  bool unblocked(Query& query, const Origin& a, const Origin& b) const;

  const Scene& scene_;
  const bool culls_;
  double offset_scale_ = 1;  // different in tests that compare two offsets
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tdpt
