// Draws segments, and directions of walks, through the portals, and tells the density with which
// any edge of a path would have been drawn so. Section 3.1.1, eq. 4.
//
// A portal is a set of triangles in the air, each with the normal its winding gives: the direction
// from the light's side to the camera's side.
//
// Portal sampling: a triangle q with probability p(q) in proportion to its area, a point uniform on
// it (p_A = 1/A_q), a direction with p_w = cos/pi about its normal, both ways to the surfaces x_l
// (light's side) and x_c (camera's side):
//   p_AA(x_l, x_c) = G(x_l, x_c) * sum_q p(q) p_A p_w / cos_q                              [eq. 4]
//                  = G(x_l, x_c) * D,    D = sum over the q crossed of p(q) / (A_q pi).
// A portal that light passes both ways is its triangles in both windings, either with its own p(q).
// cos cancels: no grazing singularity. D [1/(m2 sr)], canonical, is what this file computes.
//
// Portals in series: those that follow each other on the light's way (doors of rooms in a row)
// leave little room for light that passes both without touching a wall between them, and a segment
// through one meets the other by chance. So a share c of the segments, where there is such a pair
// (F,G), is drawn through a point uniform on each, a pair with probability p(F,G):
//   D = (1-c) sum_q p(q) / (A_q pi) + c sum over the pairs crossed of p(F,G) d^2 / (A_F A_G cos_F
//   cos_G),
// d the distance between the points where the segment passes the two.
//
// Path guiding [guide.h] aims walks at facets as light sampling aims at lamps: a facet is the
// triangles of a portal that lie in one plane [facets.h]. From v, facet F is taken in proportion to
// w_F(v), about its solid angle, and then a point uniform on it; the direction w there has
//   a(w) = sum over the facets F that the ray (v, w) passes of  w_F(v) / W  * d^2 / (|cos| A_F),
// d the distance to the plane along w, W the sum of w_F(v) over the facets that v can aim at.
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/cumulative_table.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "tools/tdpt-render/portals/facets.h"

namespace tdpt {

class PortalSet {
 public:
  PortalSet() = default;
  /// Brings portals from metres into the canonical frame; what is planar but for rounding becomes
  /// so. Degenerate triangles are dropped.
  PortalSet(const std::vector<Portal>& portals, const Frame& frame);

  bool empty() const { return polygons_.empty(); }
  /// Portals that the set was made of; one whose triangles are all degenerate counts, too.
  size_t portals() const { return portals_; }
  size_t size() const { return polygons_.size(); }
  size_t facets() const { return facets_.size(); }
  struct Outline {
    Vec3d normal, centre;
    double area;                 ///< canonical
    std::vector<Vec3d> corners;  ///< of its triangles, each once
  };
  /// Of each facet.
  std::vector<Outline> outlines() const;
  /// Of facets that segments are drawn through both of: the strongest, kMostPairs at most.
  size_t pairs() const { return pairs_.size(); }
  /// An edge is tested against those that begin with a facet it crosses: for 100 pairs of 20 facets
  /// that is an eighth more instructions.
  static constexpr size_t kMostPairs = 128;

  /// A portal counts only for segments that begin and end at least this far from its plane
  /// (canonical): where a portal lies in a surface, rounding would decide what crosses it.
  static constexpr double kMargin = 2e-6;

  /// Triangles that a segment was drawn through, the second of a pair; -1: none. They are counted
  /// as crossed, as borders round either way, and a neighbour in their plane only when the crossing
  /// is clear of the border.
  struct Drawn {
    int polygon = -1, second = -1;
  };
  /// D of the segment `from` (light's side) -> `to` (camera's side); 0 when it crosses no triangle
  /// along its normal.
  double density(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const;
  double density(const Vec3d& from, const Vec3d& to) const { return density(from, to, Drawn{}); }

  /// What can have made an edge from the light's side to the camera's.
  struct Crossing {
    double density;  ///< D
    /// a(w) * W [1/sr], of parallel light the triangles crossed [crossed_along()]: of a walk from
    /// the light that stands at `from` and is directed at `to`'s side, and of one from the camera
    /// that stands at `to`.
    double from_light, from_camera;
  };
  Crossing crossing(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const;

  /// Which way a walk goes through the portals: with the light or against it.
  enum class Way { with_light, against_light };
  /// W at `v`: of the facets that have v on the side that the way begins on, and a corner on the
  /// side of v that `facing` looks to (0: either). 0: nothing to aim at.
  double aims(const Vec3d& v, const Vec3d& facing, Way way) const;
  /// Unit direction from `v` towards a facet; W must be that of aims() for the same arguments.
  /// `u`: place on the facet, two numbers, and its choice. Returns the triangle aimed at.
  int aim(const Vec3d& v, const Vec3d& facing, Way way, double W, const std::array<double, 3>& u,
          Vec3d& w) const;

  // The same for parallel light, which travels along unit `d`: a line is drawn through a facet, one
  // in proportion to A_F cos_F, and a point uniform on it, so that all lines through portals are
  // alike: per area across d each has the density n / W, n the triangles it crosses.
  /// W.
  double aims_along(const Vec3d& d) const;
  /// The point that the line goes through; returns the triangle it lies on.
  int aim_along(const Vec3d& d, double W, const std::array<double, 3>& u, Vec3d& at) const;
  /// n of the line along d that arrives at `to`.
  int crossed_along(const Vec3d& d, const Vec3d& to, const Drawn& drawn) const;

  struct Sample {
    Drawn drawn;
    Vec3d position;   ///< x_p
    Vec3d direction;  ///< unit, towards the camera's side
  };
  /// `u`: place on a triangle and direction, two numbers each, and three for their choice. The set
  /// must not be empty.
  Sample sample(const std::array<double, 7>& u) const;
  Sample sample(Rng& rng) const;
  /// Whether x_l, x_c lie on either side of all that the segment was drawn through: one that was
  /// drawn through a pair and is stopped between them is of no use.
  bool spans(const Drawn& drawn, const Vec3d& x_l, const Vec3d& x_c) const;

  /// One triangle.
  struct Polygon {
    /// Whether a point of its plane lies in it and `inside` (barycentric) off its borders.
    bool holds(const Vec3d& at, double inside) const {
      const double b1 = dot(grad1, at - p0), b2 = dot(grad2, at - p0);
      return b1 >= inside && b2 >= inside && b1 + b2 <= 1 - inside;
    }

    Vec3d p0, e1, e2, normal;
    Vec3d grad1, grad2;  ///< barycentric b1 = dot(grad1, p - p0), b2 = dot(grad2, p - p0)
    double density;      ///< (1-c) p(q) / (A_q pi)
    uint32_t portal;     ///< which of the portals it is part of
    uint32_t facet;
  };
  const Polygon& polygon(int i) const { return polygons_[static_cast<size_t>(i)]; }

 private:
  friend struct PortalSetFaults;  // of tests [testing/faults.h]
  friend struct PortalTables;     // the same for devices

  struct Facet {
    Vec3d p0, normal, centre;
    double area = 0;
    double reach2 = 0;            ///< of the corner that is furthest from the centre, squared
    std::vector<Vec3d> corners;   ///< each once
    uint32_t first = 0, end = 0;  ///< of its triangles
    CumulativeTable table;        ///< among them, by area
    /// Of the pairs that light passes it first of.
    uint32_t first_pair = 0, end_pair = 0;
  };
  /// Two facets, light passing `first` before `second`.
  struct Pair {
    uint32_t first, second;
    double etendue;  ///< A_F A_G cos_F cos_G / d^2, from centre to centre; p(F,G) is its share
    double pdf;      ///< c p(F,G) / (A_F A_G)
  };

  void add_facet(const PlanarFacet& facet, uint32_t portal);
  void make_pairs();
  /// Where an edge from + t d crosses a facet along its normal, 0 < t < 1.
  struct Passage {
    double t, slope;  ///< slope = |d| cos
    int triangles;    ///< crossed there; 0: none
  };
  Passage passage(const Facet& f, const Vec3d& from, const Vec3d& d, const Drawn& drawn) const;
  /// The part of D that pairs have.
  double pair_density(const Vec3d& from, const Vec3d& d, const Drawn& drawn) const;
  Vec3d point_in(int triangle, double u, double v) const;
  Vec3d point_on(const Facet& f, double pick, double u, double v, int& triangle) const;
  /// How many triangles of the facet are crossed at `at`.
  int crossed(const Facet& f, const Vec3d& at, const Drawn& drawn) const;
  /// w_F(v), more than 0 off the plane.
  double weight(const Facet& f, const Vec3d& v) const;
  /// A_F cos_F of parallel light; 0 edge on and from the front.
  static double across(const Facet& f, const Vec3d& d);
  static bool aimable(const Facet& f, const Vec3d& v, const Vec3d& facing, Way way);

  std::vector<Polygon> polygons_;
  CumulativeTable table_;
  std::vector<Facet> facets_;
  std::vector<Pair> pairs_;
  CumulativeTable pair_table_;
  double pair_share_ = 0;  ///< c
  size_t portals_ = 0;
};

}  // namespace tdpt
