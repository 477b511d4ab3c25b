// A finished path with the densities of all strategies that could have sampled it.
#pragma once
#include <array>
#include <optional>

#include "tools/tdpt-render/path/light/next_event.h"
#include "tools/tdpt-render/path/sample/walk.h"

namespace tdpt::shader {
template <bool has_portals, bool any_dirac>
struct PathWeights;
}

namespace tdpt {

/// One way of sampling a path of k edges:
///   camera  split 0; direct split 1; light split k; bi split 2..k-1 (vertices from the light);
///   portal  split a = 0..k-2: the segment x_a -> x_{a+1} was drawn through a portal.
struct Strategy {
  Technique technique;
  int split;
  friend bool operator==(const Strategy&, const Strategy&) = default;
};

/// Densities of the vertices x_i of a path, i < k, for walks from the light and from the camera.
struct WalkDensities {
  struct At {
    double light_A;   ///< P>(x_i)
    double camera_A;  ///< P<(x_i)
    /// q_i > 0: the densities of x_i are divided by it.
    double common() const {
      const double q = light_A + camera_A;
      return q == 0 ? 1 : q;
    }
  };
  std::array<At, kMaxDepth + 1> at;
  At& operator[](int i) { return at[static_cast<size_t>(i)]; }
  const At& operator[](int i) const { return at[static_cast<size_t>(i)]; }
};

/// Sums over a mixture's strategies s for one path: n_s samples of each per sample of the picture,
/// which count as v_s in the weights [Mixture::sample_weight], of density p_s divided by the common
/// factor.
struct StrategySums {
  double counted = 0;  ///< sum v_s p_s
  double squares = 0;  ///< sum v_s^2 / n_s p_s
  double used = 0;     ///< n_s p_s of the strategy used
};

/// Crossings (portals.h) of a portal segment and of the edges that connect it to its prefixes.
struct SegmentCrossings {
  PortalSet::CrossingDensity own;  ///< x_l -> x_c; D is more than 0
  PortalSet::CrossingDensity
      before;  ///< last light vertex -> x_l; meaningless without a light prefix
  PortalSet::CrossingDensity
      after;  ///< x_c -> last camera vertex; meaningless if that is the camera
};

/// x_0 (on a light) ... x_k (the camera), assembled from a light prefix, 0 or 2 vertices of a
/// portal segment, and a camera prefix. Holds pointers: the walks must outlive it.
class Path {
 public:
  /// x = y_0..y_{s-1}, z_{t-1}..z_0.
  Path(const Vista& vista, const Guide& guide, const Walk& y, int s, const Walk& z, int t,
       RayCounts& rays);
  /// x = y_0..y_{s-1}, x_l, x_c, z_{t-1}..z_0.
  Path(const Vista& vista, const Guide& guide, const Walk& y, int s, const Vertex& x_l,
       const Vertex& x_c, const SegmentCrossings& segment, const Walk& z, int t, RayCounts& rays);
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

  int k() const { return k_; }
  const Vertex& vertex(int i) const { return *place(i).x; }
  /// That the camera end sees by.
  const FilmPlane& film() const { return *film_; }
  /// Whether the path scatters at x_i by a Dirac lobe: then no technique can make a connection
  /// there.
  bool dirac(int i) const { return place(i).dirac; }
  /// Survival probability at x_i, 0 < i < k, of a walk from the light or from the camera
  /// [walk.h].
  double survives(From from, int i) const { return place(i).survival[static_cast<size_t>(from)]; }

  /// MIS weight of `used` among the strategies of `mixture`, balance heuristic [eq. 6] for beta =
  /// 1, power heuristic for beta = 2. Computed from the path alone. NaN if `used` has density 0
  /// there: it cannot have made this sample, so that is a bug, to be counted.
  double weight(const Mixture& mixture, Strategy used, double beta) const;

  // The path under other mixtures than the one that made it: its contributions to their second
  // moments [pilot.h].

  /// Densities for walks like those that made it.
  const WalkDensities& walks() const { return walks_; }
  /// Densities for unguided walks.
  void plain_densities(const Vista& vista, WalkDensities& d) const;
  /// Densities for walks guided by `guide`, from the plain ones. The path must have been made with
  /// all that Guide::knowing_all() knows.
  void directed_densities(const Guide& guide, const WalkDensities& plain, WalkDensities& d) const;
  /// Sums for densities `d` of the mixture's walks, divided by the product of the q_i of `unit`. k
  /// >= 2.
  StrategySums sums(const Mixture& mixture, const WalkDensities& d, const WalkDensities& unit,
                    Strategy used) const;

 private:
  template <bool has_portals, bool any_dirac>
  friend struct shader::PathWeights;
  void fill(const Vista& vista, const Walk& y, int s, const Walk& z, int t,
            const SegmentCrossings* segment, RayCounts& rays);
  void take_light_prefix(const Walk& y, int s);
  void take_camera_prefix(const Walk& z, int t);
  void fill_joint(const Vista& vista, int s, int first_z);
  double light_survival(int i) const { return i == 0 ? 1 : survives(From::light, i - 1); }
  double camera_survival(int i) const { return survives(From::camera, i + 1); }
  /// P>(x_i) and P<(x_i) of walks that continue at the vertex before, from the finished path: plain
  /// densities, and guided ones computed from them. `e`: the edge walked, in the order of the path;
  /// `in`: how the walk arrived at the vertex that it leaves, null at the path's ends.
  double plain_light_A(const Vista& vista, int i, const Incidence* in, const Edge& e) const;
  double plain_camera_A(int i, const Edge& e, const Incidence* in) const;
  double directed_light_A(const Guide& guide, int i, double plain, const Incidence* in,
                          const Edge& e) const;
  double directed_camera_A(const Guide& guide, int i, double plain, const Edge& e,
                           const Incidence* in) const;
  /// How walks from either end arrive at x_i; null at the path's ends.
  std::optional<Incidence> from_light(int i) const;
  std::optional<Incidence> from_camera(int i) const;
  /// Survival probability at x_i, where it arrived along `in`, of a walk guided by `guide`; null:
  /// unguided.
  double survival(int i, const std::optional<Incidence>& in, const Guide* guide, From from) const;
  const Vertex& x(int i) const { return vertex(i); }
  /// x_i -> x_{i+1}; empty outside the path.
  Edge edge(int i) const { return i < 0 || i >= k_ ? Edge{} : between(x(i), x(i + 1)); }
  double strategies(const Mixture& mixture, const WalkDensities& d, Strategy used,
                    bool power) const;
  /// p_AA of x_i -> x_{i+1}, which is not the camera edge.
  double pair_A(int i) const;

  // All that is known of x_i, side by side. Separate arrays of kMaxDepth numbers would lie nearly a
  // multiple of 4096 bytes apart, and the processor would mistake reads for what was just written
  // (4K aliasing).
  struct VertexFacts {
    const Vertex* x;
    const PortalSet::CrossingDensity* crossing;  ///< of x_i -> x_{i+1}
    const Edge* edge;                ///< the same edge, from the end that its walk came from
    std::array<double, 2> survival;  ///< [From], 1 at both ends
    bool dirac;
  };
  VertexFacts& place(int i) { return places_[static_cast<size_t>(i)]; }
  const VertexFacts& place(int i) const { return places_[static_cast<size_t>(i)]; }

  const Guide& guide_;
  const FilmPlane* film_;
  int k_ = 0;
  bool any_dirac_ = false;
  NextEventPdf next_event_;                ///< p_nee(x_0): its density as a next event at x_1
  std::array<Edge, 3> joint_;              ///< edges that belong to no walk, from the light
  PortalSet::CrossingDensity connection_;  ///< for the edge that belongs to no walk and no segment
  std::array<VertexFacts, kMaxDepth + 1> places_;
  WalkDensities walks_;
};

}  // namespace tdpt
