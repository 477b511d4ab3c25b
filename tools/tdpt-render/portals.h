// The portals of a rendering: segments through them and their density. Section 3.1.1, eq. 4.
//
// A portal is a set of triangles in the air, each with the normal its winding gives: the direction
// from the light's side to the camera's side. A segment is sampled by choosing a triangle q with
// probability p(q) in proportion to its area, a point uniform on it (p_A = 1/A_q) and a direction
// with p_w = cos/pi about its normal, and following it both ways to the surfaces x_l and x_c:
//   p_AA(x_l, x_c) = G(x_l, x_c) * sum_q p(q) p_A p_w / cos_q                              [eq. 4]
//                  = G(x_l, x_c) * D,    D = sum over the q crossed of p(q) / (A_q pi).
// cos cancels: no grazing singularity. D [1/(m2 sr)], canonical, is what this file computes.
//
// Walks are directed at facets: the triangles of a portal that lie in one plane. From v, facet F is
// taken in proportion to w_F(v), about its solid angle, and then a point uniform on it; the
// direction w there has
//   pdf_w = sum over the facets F that the ray (v, w) passes of  w_F(v) / W  * d^2 / (|cos| A_F),
// d the distance to the plane along w, W the sum of w_F(v) over the facets that v can aim at.
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
  /// crossed, as borders round either way, and a neighbour in its plane only when the crossing is
  /// clear of the border; -1: none.
  double density(const Vec3d& from, const Vec3d& to, int sampled = -1) const;

  /// What can have made an edge from the light's side to the camera's.
  struct Crossing {
    double density = 0;  ///< D
    /// pdf_w * W [1/sr] of a walk from the light that stands at `from` and is directed at `to`'s
    /// side, and of one from the camera that stands at `to`.
    double from_light = 0, from_camera = 0;
  };
  Crossing crossing(const Vec3d& from, const Vec3d& to, int sampled = -1) const;

  /// Which way a walk goes through the portals: with the light or against it.
  enum class Way { with_light, against_light };
  /// W at `v`: of the facets that have v on the side that the way begins on, and a corner on the
  /// side of v that `facing` looks to (0: either). 0: nothing to aim at.
  double aims(const Vec3d& v, const Vec3d& facing, Way way) const;
  /// Unit direction from `v` towards a facet; W must be that of aims() for the same arguments.
  /// Three dimensions of `rng`. Returns the triangle aimed at.
  int aim(const Vec3d& v, const Vec3d& facing, Way way, double W, Rng& rng, Vec3d& w) const;

  struct Sample {
    int polygon;
    Vec3d position;   ///< x_p
    Vec3d direction;  ///< unit, towards the camera's side
  };
  /// Five dimensions of `rng`. The set must not be empty.
  Sample sample(Rng& rng) const;

  /// Geometry of one triangle, for tests.
  struct Polygon {
    /// Whether a point of its plane, from p0, lies in it and `inside` (barycentric) off its borders.
    bool holds(const Vec3d& at, double inside) const {
      const double b1 = dot(grad1, at), b2 = dot(grad2, at);
      return b1 >= inside && b2 >= inside && b1 + b2 <= 1 - inside;
    }

    Vec3d p0, e1, e2, normal;
    Vec3d grad1, grad2;  ///< barycentric b1 = dot(grad1, p - p0), b2 = dot(grad2, p - p0)
    double density;      ///< p(q) / (A_q pi)
    uint32_t portal;     ///< which of the portals it is part of
    uint32_t facet;
  };
  const Polygon& polygon(int i) const { return polygons_[static_cast<size_t>(i)]; }

 private:
  /// Whether triangle i is crossed at `at`, from its p0.
  bool crossed(size_t i, const Vec3d& at, int sampled) const {
    const auto s = static_cast<size_t>(sampled);
    if (sampled < 0) return polygons_[i].holds(at, 0);
    return i == s || polygons_[i].holds(at, polygons_[i].facet == polygons_[s].facet ? kBorder : 0);
  }
  static constexpr double kBorder = 1e-4;

  struct Facet {
    Vec3d p0, normal, centre;
    double area = 0;
    std::vector<Vec3d> corners;
    uint32_t first = 0, end = 0;  ///< of its triangles
    AliasTable table;             ///< among them, by area
  };
  void make_facets();
  /// w_F(v), more than 0 off the plane.
  static double weight(const Facet& f, const Vec3d& v);
  static bool aimable(const Facet& f, const Vec3d& v, const Vec3d& facing, Way way);

  std::vector<Polygon> polygons_;
  AliasTable table_;
  std::vector<Facet> facets_;
  size_t portals_ = 0;
};

}  // namespace tdpt
