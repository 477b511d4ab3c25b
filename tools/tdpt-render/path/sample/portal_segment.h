// A portal segment that a sample has drawn, with the light that arrives at its end x_l: the third
// kind of sub-path. Section 3.1.1, eq. 2.
#pragma once
#include <vector>

#include "tools/tdpt-render/path/sample/walk.h"

namespace tdpt {

/// A prefix of a light walk, connected with x_l.
struct Side {
  const Walk* walk;
  int prefix;  ///< number of its vertices; 0: light begins at x_l
  Rgb value;   ///< throughput and scattering at both ends, over the probability of being chosen
  double chance;
  PortalSet::CrossingDensity crossing{};  ///< of the connecting edge
};

struct PortalSegment {
  Vertex x_l, x_c;
  Vec3d w;  ///< unit, from x_l to x_c
  PortalSet::CrossingDensity crossing{};
  double opacity = 1;  ///< coverage of both ends' surfaces (Hit::opacity)
  /// Throughput of both ends together, the G of edge C2 of [eq. 2] over its density: G / p_AA = 1 /
  /// D, and over the share of samples that draw a segment.
  Rgb through;
  std::vector<Side> light;  ///< the prefixes connected with x_l
  /// The sample that drew it.
  int x = 0, y = 0;
  uint64_t sample = 0;
  uint32_t portal = 0;
  bool lit = false;  ///< has contributed light
};

}  // namespace tdpt
