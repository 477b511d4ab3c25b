// The sub-paths of bidirectional path tracing: random walks from the camera and from a light.
// Section 3.1.2.
#pragma once
#include "libcommon/math/sequence.h"
#include "tools/tdpt-render/path/guide.h"
#include "tools/tdpt-render/path/tally.h"

namespace tdpt {

/// Longest path: 64 edges.
constexpr int kMaxDepth = 64;

/// What a walk knows of its own at one of its vertices.
struct WalkState {
  /// Of all before, without what is emitted or scattered here: 1 / pdf of the place on a light,
  /// emission and f cos over their densities, transmittance over coverage.
  Rgb throughput{};
  double pdf_own_A = 0;  ///< of the vertex, sampled by this walk
  double pdf_other_A =
      0;  ///< as a walk from the other end would sample it; known two vertices later
  PortalSet::Crossing crossing{};  ///< of the edge to the vertex before (portals.h)
  bool dirac = false;              ///< the walk went on by a Dirac lobe
};

struct Walk {
  std::array<Vertex, kMaxDepth + 1> v;
  std::array<WalkState, kMaxDepth + 1> states;
  int size = 0;
  const Vertex& operator[](int i) const { return v[static_cast<size_t>(i)]; }
  const WalkState& state(int i) const { return states[static_cast<size_t>(i)]; }
};

/// y_0 alone, a walk of no edges.
void begin_at_light(const World& world, const Guide& guide, const Lights::Point& light, Walk& walk);

/// z_0 at the pinhole, z_1 ... z_n, n <= edges, through raster place (x, y).
void walk_from_camera(const World& world, const Guide& guide, double x, double y, int edges,
                      Sequence numbers, Walk& walk, RayCounts& rays);

/// y_0 on a light, y_1 ... y_n, n <= edges.
void walk_from_light(const World& world, const Guide& guide, int edges, Sequence numbers,
                     Walk& walk, RayCounts& rays);

}  // namespace tdpt
