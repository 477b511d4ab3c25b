// Where rays meet a scene: the closest hit, and whether two places see each other, in the canonical
// frame.
//
// Method: ray casting by a bounding volume hierarchy (Embree, which stays behind this header), in
// floats; hit points are computed anew from barycentrics in double precision and never moved.
//
// Self-intersection: rays start exactly on surfaces, so their origins are moved off the surface by
// a few units in the last place of its coordinates, along the geometric normal to the side the ray
// leaves on; from a place in the air (a lamp or camera may stand in a surface all the same) along
// the ray.
//
// Stochastic transparency: surfaces that are not opaque (alpha) and window panes (pane.h) cover a
// share of each of their points, `coverage`, and stop that share of the rays: those that a hash of
// the exact point picks. So a blend of 0.3 is met by three rays of ten, and no ray needs random
// numbers of its own. A pane covers as much as it reflects; its transmittance is the rest.
//
// Culling: rays from a camera and to it may pass the backs of single-sided surfaces; which side is
// met depends on the ray alone, so that is a coverage of 0 or 1.
#pragma once
#include <memory>

#include "libcommon/scene/scene.h"

namespace tdpt {

struct Hit {
  uint32_t triangle = ~0u;
  double b1, b2;    ///< barycentrics of vertices 1 and 2
  double distance;  ///< from the true origin to the true hit point
  Vec3d position;   ///< p0 + b1 e1 + b2 e2
  Vec3d normal;     ///< unit geometric normal of the front side (counter-clockwise)
  /// Coverage of a pane: probability that a ray at this angle is stopped by it; what it scatters is
  /// to be divided by it. 1 for all else: a blend scatters its alpha's share, so the two cancel.
  double opacity = 1;
};

class Tracer {
 public:
  /// Builds the hierarchy; keeps a reference to `scene`. `culls`: of cameras [Camera::culls].
  explicit Tracer(const Scene& scene, bool culls = false);
  ~Tracer();
  bool culls() const { return culls_; }

  /// A place rays start from. `normal` (unit, either side) says how to step off the surface; zero
  /// for places in the air (camera, lamp, portal).
  struct Origin {
    Vec3d position;
    Vec3d normal{};
  };

  /// First surface along unit direction `w`; false when there is none. Also false where it is at
  /// `from` itself, but then `hit` has its triangle: nothing was left.
  bool closest(const Origin& from, const Vec3d& w, Hit& hit) const;

  /// The same from exactly that place: rays both ways along a line from one place meet each surface
  /// once, and miss none.
  bool closest_from(const Vec3f& from, const Vec3d& w, Hit& hit) const;

  /// Whether nothing lies between two places, both ends stepped off their own surfaces.
  bool visible(const Origin& a, const Origin& b) const;

  /// The same for a camera at that place.
  bool first_seen(const Vec3d& camera, const Vec3d& w, Hit& hit) const {
    return culls_ ? first_drawn(camera, w, hit) : closest({camera}, w, hit);
  }
  bool sees(const Vec3d& camera, const Origin& place) const {
    return culls_ ? no_front_between(camera, place) : visible(place, {camera});
  }
  /// Whether a camera that looks along `w`, of any length, sees the side of a triangle that it
  /// looks at.
  bool draws(uint32_t triangle, const Vec3d& w) const {
    return !culls_ || dot(shape(triangle).normal, w) <= 0 || !scene_.single_sided(triangle);
  }

  /// For kernels that count in floats and step off themselves: first surface beyond `from` along
  /// `w`, of any length. `coin`, a number of the ray's own, decides with the triangle's whether a
  /// surface that is not opaque is there (surface_stops() of shaders/shared/coverage.h).
  struct FloatHit {
    float t;  ///< in units of w
    uint32_t triangle;
    float b1, b2;
    bool back;  ///< the side that is met
  };
  bool first_hit(const Vec3f& from, const Vec3f& w, uint32_t coin, FloatHit& hit) const;
  /// Whether something lies between `a` and `b`; in floats, as above.
  bool segment_blocked(const Vec3f& a, const Vec3f& b, uint32_t coin) const;

  /// Geometry of a triangle, computed once.
  const TriangleShape& shape(uint32_t triangle) const;

 private:
  friend struct TracerFaults;  // of tests [libcommon/testing/tracer_faults.h]

  Vec3f step_off(const Origin& from, const Vec3d& w) const;
  bool first_drawn(const Vec3d& camera, const Vec3d& w, Hit& hit) const;
  bool no_front_between(const Vec3d& camera, const Origin& place) const;
  template <class Query>
  bool first_surface(Query& query, const Vec3f& o, const Vec3d& from, const Vec3d& w,
                     Hit& hit) const;
  template <class Query>
  bool unblocked(Query& query, const Origin& a, const Origin& b) const;

  const Scene& scene_;
  const bool culls_;
  double offset_scale_ = 1;  // another in tests that compare two
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tdpt
