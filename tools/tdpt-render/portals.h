// The portals of a rendering: segments through them and their density. Section 3.1.1, eq. 4.
//
// A portal is a set of triangles in the air, each with the normal its winding gives: the direction
// from the light's side to the camera's side. A segment is sampled by choosing a triangle q with
// probability p(q) in proportion to its area, a point uniform on it (p_A = 1/A_q) and a direction
// with p_w = cos/pi about its normal, and following it both ways to the surfaces x_l and x_c:
//   p_AA(x_l, x_c) = G(x_l, x_c) * sum_q p(q) p_A p_w / cos_q                              [eq. 4]
//                  = G(x_l, x_c) * D,    D = sum over the q crossed of p(q) / (A_q pi).
// cos cancels: no grazing singularity. D [1/(m2 sr)], canonical, is what this file computes.
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

class PortalSet {
 public:
  PortalSet() = default;
  /// Brings portals from metres into the canonical frame. Degenerate triangles are dropped.
  PortalSet(const std::vector<Portal>& portals, const Frame& frame);

  bool empty() const { return polygons_.empty(); }
  /// Portals that the set was made of; one whose triangles are all degenerate counts, too.
  size_t portals() const { return portals_; }
  size_t size() const { return polygons_.size(); }

  /// A portal counts only for segments that begin and end at least this far from its plane
  /// (canonical): where a portal lies in a surface, rounding would decide what crosses it.
  static constexpr double kMargin = 2e-6;

  /// D of the segment `from` (light's side) -> `to` (camera's side); 0 when it crosses no triangle
  /// along its normal. `sampled`: the triangle that the segment was drawn from is counted as
  /// crossed, as borders round either way; -1: none.
  double density(const Vec3d& from, const Vec3d& to, int sampled = -1) const;

  struct Sample {
    int polygon;
    Vec3d position;   ///< x_p
    Vec3d direction;  ///< unit, towards the camera's side
  };
  /// Five dimensions of `rng`. The set must not be empty.
  Sample sample(Rng& rng) const;

  /// Geometry of one triangle, for tests.
  struct Polygon {
    Vec3d p0, e1, e2, normal;
    Vec3d grad1, grad2;  ///< barycentric b1 = dot(grad1, p - p0), b2 = dot(grad2, p - p0)
    double density;      ///< p(q) / (A_q pi)
    uint32_t portal;     ///< which of the portals it is part of
  };
  const Polygon& polygon(int i) const { return polygons_[static_cast<size_t>(i)]; }

 private:
  std::vector<Polygon> polygons_;
  AliasTable table_;
  size_t portals_ = 0;
};

}  // namespace tdpt
