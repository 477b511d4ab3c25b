// The portals of a scene: samples segments and directions of walks through portals and gives their
// densities, by the code of shaders/shared/path/portals.h in doubles. Method and symbols are
// described there.
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/path/portal_layout.h"

namespace tdpt::shader {
struct PortalText;
}

namespace tdpt {

using Corners = std::array<Vec3d, 3>;

/// A portal in one plane of the canonical frame, whose normal is the mean of its triangles' normals
/// weighted by area.
struct FlatPortal {
  Vec3d normal;                    ///< unit; faces as most of the area is drawn
  std::vector<Corners> triangles;  ///< those with an area, counter-clockwise seen from its tip
  double off = 0;                  ///< largest distance of a drawn corner from the plane
  double width = 0;                ///< twice the largest distance of a corner from the centre
};
FlatPortal flattened(const Portal& portal, const Frame& frame);

class PortalSet {
 public:
  PortalSet() = default;
  /// Converts portals from metres into the canonical frame, each laid into its plane: one facet, or
  /// two that face opposite ways.
  PortalSet(const std::vector<Portal>& portals, const Frame& frame);

  bool empty() const { return polygons_.empty(); }
  /// Number of portals given, including any without triangles.
  size_t portals() const { return portals_; }
  size_t size() const { return polygons_.size(); }
  size_t facets() const { return facets_.size(); }
  struct Outline {
    Vec3d normal, centre;
    double area;                 ///< canonical
    std::vector<Vec3d> corners;  ///< of its triangles, without duplicates
  };
  /// One for each facet.
  std::vector<Outline> outlines() const;
  /// Number of pairs of facets that segments are drawn through both of: the strongest, at most
  /// kMostPairs.
  size_t pairs() const { return pairs_.size(); }
  /// An edge is tested against the pairs that begin with a facet it crosses: for 100 pairs of 20
  /// facets that is an eighth more instructions.
  static constexpr size_t kMostPairs = 128;

  /// A portal counts only for segments that begin and end at least this far from its plane.
  static inline const double kMargin = shader::kPlaneMargin;

  /// Triangles that a segment was drawn through, the second one for a pair; -1: none. They always
  /// count as crossed, although rounding at a border may go either way; a neighbour in the same
  /// plane then counts only if the crossing is clear of the border.
  struct Drawn {
    int polygon = -1, second = -1;
  };
  /// D of the segment `from` (light's side) -> `to` (camera's side); 0 if it crosses no triangle
  /// along its normal.
  double density(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const;
  double density(const Vec3d& from, const Vec3d& to) const { return density(from, to, Drawn{}); }

  /// Densities of what can have made an edge from the light's side to the camera's.
  struct CrossingDensity {
    double density;  ///< D
    /// a(w) * W [1/sr] (for parallel light: the triangles crossed [crossed_along()]) of a guided
    /// walk from the light at `from`, aiming to the side of `to`, and of one from the camera at
    /// `to`.
    double from_light, from_camera;
  };
  CrossingDensity crossing(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const;

  /// W of parallel light that travels along unit `d`.
  double guide_total_along(const Vec3d& d) const;

  struct Sample {
    Drawn drawn;
    Vec3d position;   ///< x_p
    Vec3d direction;  ///< unit, towards the camera's side
    uint32_t portal = 0;
  };
  /// `u`: two numbers for the place on a triangle, two for the direction, three to choose
  /// triangles. The set must not be empty.
  Sample sample(const std::array<double, 7>& u) const;
  Sample sample(Rng& rng) const;
  /// Whether x_l and x_c lie on either side of all triangles that the segment was drawn through:
  /// one drawn through a pair and stopped in between is of no use.
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
  friend struct PortalSetFaults;  // for tests [testing/faults.h]
  friend struct PortalTables;     // the same tables for devices

  using Facet = shader::PortalFacetOf<double>;

  void add_facet(const FlatPortal& flat, uint32_t portal);
  void make_pairs();
  std::vector<Vec3d> corners_of(const Facet& f) const {
    return {corners_.begin() + f.first_corner, corners_.begin() + f.end_corner};
  }

  std::vector<Facet> facets_;
  std::vector<shader::PortalPolygonOf<double>> polygons_;
  std::vector<Vec3d> corners_;  // of facets, without duplicates
  std::vector<shader::PortalPairOf<double>> pairs_;
  /// Sizes of the tables, and the share c of the segments that is drawn through pairs.
  struct Sizes {
    uint32_t facets = 0, polygons = 0, pairs = 0;
    double pair_share = 0, per_pair_share = 0;
  } sizes_;
  size_t portals_ = 0;
};

}  // namespace tdpt
