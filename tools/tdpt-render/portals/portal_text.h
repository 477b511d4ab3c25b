// The code of shaders/shared/path/portals.h in doubles, for callers that make many calls to it.
#pragma once
#include "shaders/shared/warp.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt::shader {

struct PortalText {
  explicit PortalText(const PortalSet& portals) : set(portals) {}

  using Real = double;
  using Drawn = PortalSet::Drawn;
  using CrossingDensity = PortalSet::CrossingDensity;
  using SegmentDraw = PortalSet::Sample;
  using PortalFacet = PortalFacetOf<double>;
  using PortalPolygon = PortalPolygonOf<double>;
  using PortalPair = PortalPairOf<double>;
  struct PortalPassage {
    double before, after, cosine;
    int triangles;
  };
  struct Corner {
    Vec3d at;
  };
  static inline const double kPortalMargin = kPlaneMargin;
  static constexpr double kPortalEdgeOn = 1e-6;
  static constexpr double kPortalReach = HUGE_VAL;
  static constexpr bool scene_has_portals = true;

  const PortalSet& set;
  bool portals_have_pairs = set.sizes_.pairs > 0;
  const PortalSet::Sizes& guiding = set.sizes_;

  const PortalFacet& load_portal_facet(uint i) const { return set.facets_[i]; }
  const PortalPolygon& load_portal_polygon(uint i) const { return set.polygons_[i]; }
  Corner load_portal_corner(uint i) const { return {set.corners_[i]}; }
  const PortalPair& load_portal_pair(uint i) const { return set.pairs_[i]; }
  static CrossingDensity no_crossing() { return {}; }

#include "shaders/shared/path/portals.h"
};

}  // namespace tdpt::shader
