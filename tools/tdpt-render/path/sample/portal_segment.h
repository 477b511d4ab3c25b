// A portal segment that a sample has drawn, with what light comes to its end x_l: the third kind of
// sub-path. Section 3.1.1, eq. 2.
#pragma once
#include <vector>

#include "tools/tdpt-render/path/sample/walk.h"

namespace tdpt {

/// A prefix of a light walk that x_l is connected with.
struct Side {
  const Walk* walk;
  int prefix;  ///< vertices of it; 0: light begins at x_l
  Rgb value;   ///< throughput and what is scattered at both, over the chance of being taken
  double chance;
  PortalSet::CrossingDensity crossing{};  ///< of the edge that connects them
};

struct PortalSegment {
  Vertex x_l, x_c;
  Vec3d w;  ///< unit, from x_l to x_c
  PortalSet::CrossingDensity crossing{};
  double opacity = 1;  ///< coverage of both ends' surfaces (Hit::opacity)
  /// One throughput for both ends, the G of edge C2 of [eq. 2] over its density: G / p_AA = 1 / D;
  /// a share of the samples stands for all.
  Rgb through;
  std::vector<Side> light;  ///< at x_l
  /// The sample that drew it.
  int x = 0, y = 0;
  uint64_t sample = 0;
  uint32_t portal = 0;
  bool lit = false;  ///< has brought light
};

}  // namespace tdpt
