// The sub-paths of bidirectional path tracing: random walks from the camera and from a light.
// Section 3.1.2.
#pragma once
#include <vector>

#include "libcommon/math/sequence.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/guide.h"
#include "tools/tdpt-render/path/sample/tally.h"

namespace tdpt {

/// What a walk stores for one of its vertices.
struct WalkState {
  /// Throughput up to the vertex, without emission or scattering there: 1 / pdf of the place on a
  /// light, emission and f cos over their densities, transmittance over coverage.
  Rgb throughput{};
  double pdf_own_A = 0;  ///< density of the vertex in this walk
  /// Density in a walk from the other end that continues from the next vertex; known two vertices
  /// later.
  double pdf_other_A = 0;
  /// Survival probability here: of this walk and, known one vertex later, of one from the other
  /// end.
  double own_survival = 1, other_survival = 1;
  Edge edge{};                            ///< from the vertex before
  PortalSet::CrossingDensity crossing{};  ///< of that edge (portals.h)
  bool dirac = false;                     ///< the walk continued by a Dirac lobe
};

struct Walk {
  std::vector<Vertex> v;          ///< the first `size` are in use
  std::vector<WalkState> states;  ///< likewise
  int size = 0;
  const FilmPlane* film = nullptr;  ///< that a walk from the camera began at
  /// Makes room for one more vertex; existing ones may move.
  void make_place() {
    if (v.size() > static_cast<size_t>(size)) return;
    v.resize(2 * v.size() + 8);
    states.resize(v.size());
  }
  const Vertex& operator[](int i) const { return v[static_cast<size_t>(i)]; }
  const WalkState& state(int i) const { return states[static_cast<size_t>(i)]; }
};

/// Unit direction from vertex i back to the vertex before it; 0 at the first vertex.
inline Vec3d way_back(const Walk& walk, int i) {
  if (i == 0) return {};
  return -walk.state(i).edge.w;
}

/// y_0 alone, a walk without edges; its guide totals are not yet set
/// [Guide::set_totals_at_light].
void begin_at_light(const World& world, const Lights::Point& light, Walk& walk);

/// z_0 at the pinhole of `film`, which must outlive the walk, z_1 ... z_n, n <= edges, through
/// raster place (x, y).
void walk_from_camera(const Vista& vista, const Guide& guide, const FilmPlane& film, double x,
                      double y, int edges, Sequence numbers, Walk& walk, RayCounts& rays);

/// y_0 on a light, y_1 ... y_n, n <= edges.
void walk_from_light(const Vista& vista, const Guide& guide, int edges, Sequence numbers,
                     Walk& walk, RayCounts& rays);

// Russian roulette: ends walks whose length is not fixed.
//
// Method: a walk survives a vertex with probability equal to the albedo there, so that its
// throughput neither fades nor grows; the mean number of bounces in a closed room of albedo a is
// 1/(1-a). It always survives the first vertex: z_1, since a dark pixel is as dark as what it sees
// and the error of a picture is relative; y_1 likewise. More or fewer such vertices, and other
// powers of the albedo, change time and variance by the same factor: error x work is flat.
//
// Survival depends only on a vertex, the one before it and its place in the walk. So it is a factor
// of the densities P> and P< of the next vertex, from which all MIS weights are made: they know
// that a strategy which needs a long walk is rare.

/// Longest path [edges]. Few walks get so far: of a million with albedo 0.99, 34.
constexpr int kMaxDepth = 1024;

/// Whether walks always survive their vertex i: y_0, y_1, z_0, z_1.
constexpr bool always_goes_on(int i) {
  return i <= 1;
}

}  // namespace tdpt
