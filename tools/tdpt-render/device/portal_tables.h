// Portals as tables for kernels and their scalar build [shaders/shared/path/portal_layout.h].
#pragma once
#include <vector>

#include "shaders/shared/path/portal_layout.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

/// All empty, and `guiding` 0, if there are no portals.
struct PortalTables {
  PortalTables() = default;
  explicit PortalTables(const PortalSet& set);

  std::vector<shader::PortalFacet> facets;
  std::vector<shader::PortalPolygon> polygons;
  std::vector<shader::PortalCorner> corners;
  std::vector<shader::PortalPair> pairs;
  shader::GuideParameters guiding{};
};

}  // namespace tdpt
