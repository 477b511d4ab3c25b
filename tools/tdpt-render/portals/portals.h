// The portals of a scene: samples segments and directions of walks through portals and gives their
// densities, by the code of shaders/shared/path/portals.h in doubles. Method and symbols are
// described there.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/warp.h"

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

struct PortalSetFaults;  // for tests [testing/faults.h]
struct PortalTables;     // the same tables for devices

}  // namespace tdpt

namespace tdpt::shader {

/// Copies share their tables.
class PortalSet {
 public:
  PortalSet() = default;
  /// Converts portals from metres into the canonical frame, each laid into its plane: one facet, or
  /// two that face opposite ways.
  PortalSet(const std::vector<Portal>& portals, const Frame& frame);

  bool empty() const { return guiding.polygons == 0; }
  /// Number of portals given, including any without triangles.
  size_t portals() const { return portals_; }
  size_t size() const { return guiding.polygons; }
  size_t facets() const { return guiding.facets; }
  /// The corners of a facet's triangles, without duplicates.
  std::vector<Vec3d> corners_of(const PortalFacetOf<double>& f) const {
    const auto begin = tables_->corners.begin();
    return {begin + f.first_corner, begin + f.end_corner};
  }
  /// Number of pairs of facets that segments are drawn through both of: the strongest, at most
  /// kMostPairs.
  size_t pairs() const { return guiding.pairs; }
  /// An edge is tested against the pairs that begin with a facet it crosses: for 100 pairs of 20
  /// facets that is an eighth more instructions.
  static constexpr size_t kMostPairs = 128;

  // What the shared code needs. Its records are described in portal_layout.h.
  using Real = double;
  using PortalFacet = PortalFacetOf<double>;
  using PortalPolygon = PortalPolygonOf<double>;
  using PortalPair = PortalPairOf<double>;
  struct Drawn {
    int polygon = -1, second = -1;
  };
  struct CrossingDensity {
    double density, from_light, from_camera;
  };
  struct SegmentDraw {
    Drawn drawn;
    Vec3d position, direction;
    uint32_t portal = 0;
  };
  struct PortalPassage {
    double before, after, cosine;
    double coverage;
  };
  struct PortalCorner {
    Vec3d at;
  };
  /// A portal counts only for segments that begin and end at least this far from its plane.
  static inline const double kPortalMargin = kPlaneMargin;
  static constexpr double kPortalEdgeOn = 1e-6;
  static constexpr double kPortalReach = HUGE_VAL;
  static constexpr bool scene_has_portals = true;
  bool portals_have_pairs = false;
  struct {
    uint32_t facets = 0, polygons = 0, pairs = 0;
    double pair_share = 0, per_pair_share = 0;
  } guiding;

  const PortalFacet& load_portal_facet(uint i) const { return tables_->facets[i]; }
  const PortalPolygon& load_portal_polygon(uint i) const { return tables_->polygons[i]; }
  PortalCorner load_portal_corner(uint i) const { return {tables_->corners[i]}; }
  const PortalPair& load_portal_pair(uint i) const { return tables_->pairs[i]; }
  static CrossingDensity no_crossing() { return {}; }

#include "shaders/shared/path/portals.h"

  double density(const Vec3d& from, const Vec3d& to, const Drawn& drawn) const {
    return portal_density(from, to, drawn);
  }
  double density(const Vec3d& from, const Vec3d& to) const {
    return density(from, to, Drawn());
  }
  /// The set must not be empty.
  SegmentDraw sample(const std::array<double, 7>& u) const {
    return sample_segment(u[0], u[1], u[2], u[3], u[4], u[5], u[6]);
  }
  SegmentDraw sample(tdpt::Rng& rng) const;

  /// A triangle, or the surround of a facet.
  struct Polygon : PortalPolygon {
    Vec3d normal;
    bool surround;
    double area;
    double density;  ///< (1-c) p(q) / (A_q pi)
  };
  bool holds(const Polygon& q, const Vec3d& at) const {
    return q.surround ? surround_holds(q, at) : triangle_holds(q, at, 0);
  }
  Polygon polygon(int i) const {
    const PortalPolygon& q = load_portal_polygon(static_cast<uint>(i));
    const PortalFacet& f = load_portal_facet(q.facet);
    const bool surround = static_cast<uint>(i) + 1 == f.end;
    return {q, f.normal, surround, length(cross(q.e1, q.e2)) * (surround ? 1 : 0.5),
            f.density * (surround ? f.surround : 1 - Real{kSurroundShare})};
  }

 private:
  friend struct tdpt::PortalSetFaults;
  friend struct tdpt::PortalTables;

  void add_facet(const FlatPortal& flat, uint32_t portal);
  void add_polygon(const Vec3d& p0, const Vec3d& e1, const Vec3d& e2, const Vec3d& normal,
                   uint32_t portal);
  void make_pairs();

  struct Tables {
    std::vector<PortalFacet> facets;
    std::vector<PortalPolygon> polygons;
    std::vector<Vec3d> corners;  // of facets, without duplicates
    std::vector<PortalPair> pairs;
  };
  std::shared_ptr<Tables> tables_ = std::make_shared<Tables>();
  size_t portals_ = 0;
};

}  // namespace tdpt::shader

namespace tdpt {
using shader::PortalSet;
}
