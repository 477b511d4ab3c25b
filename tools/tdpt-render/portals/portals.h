// The portals of a scene, and the text of shaders/shared/path/portals.h on them in doubles:
// segments and directions of walks through portals, and their densities. The method and all symbols
// are told there.
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/path/portal_layout.h"
#include "tools/tdpt-render/portals/facets.h"

namespace tdpt::shader {
struct PortalText;
}

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

  /// A portal counts only for segments that begin and end at least this far from its plane.
  static inline const double kMargin = shader::kPlaneMargin;

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
  struct CrossingDensity {
    double density;  ///< D
    /// a(w) * W [1/sr], of parallel light the triangles crossed [crossed_along()]: of a walk from
    /// the light that stands at `from` and is directed at `to`'s side, and of one from the camera
    /// that stands at `to`.
    double from_light, from_camera;
  };
  CrossingDensity crossing(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const;

  /// W of parallel light, which travels along unit `d`.
  double guide_total_along(const Vec3d& d) const;

  struct Sample {
    Drawn drawn;
    Vec3d position;   ///< x_p
    Vec3d direction;  ///< unit, towards the camera's side
    uint32_t portal = 0;
  };
  /// `u`: place on a triangle and direction, two numbers each, and three for their choice. The set
  /// must not be empty.
  Sample sample(const std::array<double, 7>& u) const;
  Sample sample(Rng& rng) const;
  /// Whether x_l, x_c lie on either side of all that the segment was drawn through: one that was
  /// drawn through a pair and is stopped between them is of no use.
  bool spans(const Drawn& drawn, const Vec3d& x_l, const Vec3d& x_c) const;
  /// Where both rays of a segment begin: behind the portal by half the margin.
  Vec3d start(const Sample& sample) const;

  /// One triangle.
  struct Polygon : shader::PortalPolygonOf<double> {
    Vec3d normal;
    double density;  ///< (1-c) p(q) / (A_q pi)
  };
  Polygon polygon(int i) const {
    const auto& q = polygons_[static_cast<size_t>(i)];
    return {q, facets_[q.facet].normal, facets_[q.facet].density};
  }

 private:
  friend struct shader::PortalText;
  friend struct PortalSetFaults;  // of tests [testing/faults.h]
  friend struct PortalTables;     // the same for devices

  using Facet = shader::PortalFacetOf<double>;

  void add_facet(const PlanarFacet& facet, uint32_t portal);
  void make_pairs();
  std::vector<Vec3d> corners_of(const Facet& f) const {
    return {corners_.begin() + f.first_corner, corners_.begin() + f.end_corner};
  }

  std::vector<Facet> facets_;
  std::vector<shader::PortalPolygonOf<double>> polygons_;
  std::vector<Vec3d> corners_;  // of facets, each once
  std::vector<shader::PortalPairOf<double>> pairs_;
  /// Of the tables, and of the segments the share c that is drawn through pairs.
  struct Sizes {
    uint32_t facets = 0, polygons = 0, pairs = 0;
    double pair_share = 0, per_pair_share = 0;
  } sizes_;
  size_t portals_ = 0;
};

}  // namespace tdpt
