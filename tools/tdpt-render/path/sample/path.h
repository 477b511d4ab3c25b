// A finished path with the densities of everything that could have sampled it.
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
///   portal  split a = 0..k-2: the segment x_a -> x_{a+1} came through a portal.
struct Strategy {
  Technique technique;
  int split;
  friend bool operator==(const Strategy&, const Strategy&) = default;
};

/// Densities of the vertices x_i of a path, i < k, in walks from the light and from the camera.
struct WalkDensities {
  struct At {
    double light_A;   ///< P>(x_i)
    double camera_A;  ///< P<(x_i)
    /// q_i, more than 0, by which the densities of x_i are divided.
    double common() const {
      const double q = light_A + camera_A;
      return q == 0 ? 1 : q;
    }
  };
  std::array<At, kMaxDepth + 1> at;
  At& operator[](int i) { return at[static_cast<size_t>(i)]; }
  const At& operator[](int i) const { return at[static_cast<size_t>(i)]; }
};

/// What a mixture's strategies s make of a path together: n_s samples of each in a sample of the
/// picture, which count as v_s in the weights [Mixture::sample_weight], of density p_s over what is
/// common to all.
struct StrategySums {
  double counted = 0;  ///< sum v_s p_s
  double squares = 0;  ///< sum v_s^2 / n_s p_s
  double used = 0;     ///< n_s p_s of one of them
};

/// Crossings (portals.h) of a portal segment and of the edges that connect it to its prefixes.
struct SegmentCrossings {
  PortalSet::CrossingDensity own;  ///< x_l -> x_c; D is more than 0
  PortalSet::CrossingDensity
      before;  ///< last light vertex -> x_l; of no meaning without a light prefix
  PortalSet::CrossingDensity
      after;  ///< x_c -> last camera vertex; of no meaning when that is the camera
};

/// x_0 (on a light) ... x_k (the camera), assembled from a light prefix, 0 or 2 vertices of a
/// portal segment, and a camera prefix. Holds pointers: the walks must outlive it.
class Path {
 public:
  /// x = y_0..y_{s-1}, z_{t-1}..z_0.
  Path(const World& world, const Guide& guide, const Walk& y, int s, const Walk& z, int t,
       RayCounts& rays);
  /// x = y_0..y_{s-1}, x_l, x_c, z_{t-1}..z_0.
  Path(const World& world, const Guide& guide, const Walk& y, int s, const Vertex& x_l,
       const Vertex& x_c, const SegmentCrossings& segment, const Walk& z, int t, RayCounts& rays);
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

  int k() const { return k_; }
  const Vertex& vertex(int i) const { return *place(i).x; }
  /// Whether the path turns at x_i by a Dirac lobe: then no technique can make a connection there.
  bool dirac(int i) const { return place(i).dirac; }
  /// Probability that a walk from the light, from the camera goes on at x_i, 0 < i < k
  /// [roulette.h].
  double survives(From from, int i) const { return place(i).survival[static_cast<size_t>(from)]; }

  /// MIS weight of `used` among the strategies of `mixture`, balance heuristic [eq. 6] for beta =
  /// 1, power heuristic for beta = 2. Computed from the path alone. NaN when `used` has no density
  /// there: a sample that it cannot have made is a bug, to be counted.
  double weight(const Mixture& mixture, Strategy used, double beta) const;

  // The path under other mixtures than that which made it: what it brings to their second moments
  // [pilot.h].

  /// Densities in walks as those that made it.
  const WalkDensities& walks() const { return walks_; }
  /// Densities where no walk is directed.
  void plain_densities(const World& world, WalkDensities& d) const;
  /// And where they are directed by `guide`, from the plain ones. What Guide::knowing_all() knows
  /// must have been known to those that made the path.
  void directed_densities(const Guide& guide, const WalkDensities& plain, WalkDensities& d) const;
  /// Densities `d` of the mixture's walks, over the product of the q_i of `unit`. k >= 2.
  StrategySums sums(const Mixture& mixture, const WalkDensities& d, const WalkDensities& unit,
                    Strategy used) const;

 private:
  template <bool has_portals, bool any_dirac>
  friend struct shader::PathWeights;
  void fill(const World& world, const Walk& y, int s, const Walk& z, int t,
            const SegmentCrossings* segment, RayCounts& rays);
  void take_light_prefix(const Walk& y, int s);
  void take_camera_prefix(const Walk& z, int t);
  void fill_joint(const World& world, int s, int first_z);
  double light_survival(int i) const { return i == 0 ? 1 : survives(From::light, i - 1); }
  double camera_survival(int i) const { return survives(From::camera, i + 1); }
  /// P>(x_i) and P<(x_i) of walks that go on at the vertex before, from the finished path: of plain
  /// walks, and directed ones from these. `e`: the edge that is walked, in the order of the path;
  /// `in`: how the vertex that it leaves was come to, null at the path's ends.
  double plain_light_A(const World& world, int i, const Incidence* in, const Edge& e) const;
  double plain_camera_A(const World& world, int i, const Edge& e, const Incidence* in) const;
  double directed_light_A(const Guide& guide, int i, double plain, const Incidence* in,
                          const Edge& e) const;
  double directed_camera_A(const Guide& guide, int i, double plain, const Edge& e,
                           const Incidence* in) const;
  /// How walks of either kind come to x_i; none at the path's ends.
  std::optional<Incidence> from_light(int i) const;
  std::optional<Incidence> from_camera(int i) const;
  const Vertex& x(int i) const { return vertex(i); }
  /// x_i -> x_{i+1}; nothing beyond the ends.
  Edge edge(int i) const { return i < 0 || i >= k_ ? Edge{} : between(x(i), x(i + 1)); }
  double strategies(const Mixture& mixture, const WalkDensities& d, Strategy used,
                    bool power) const;
  /// p_AA of x_i -> x_{i+1}, which is not the camera's own.
  double pair_A(int i) const;

  // What is known of x_i, side by side: arrays of kMaxDepth numbers each would lie a multiple of
  // 4096 bytes and a few apart, where a processor takes what is read for what was just written.
  struct VertexFacts {
    const Vertex* x;
    const PortalSet::CrossingDensity* crossing;  ///< of x_i -> x_{i+1}
    const Edge* edge;                            ///< the same, from the end that its walk came from
    std::array<double, 2> survival;              ///< [From], 1 at both ends
    bool dirac;
  };
  VertexFacts& place(int i) { return places_[static_cast<size_t>(i)]; }
  const VertexFacts& place(int i) const { return places_[static_cast<size_t>(i)]; }

  const Guide& guide_;
  int k_ = 0;
  bool any_dirac_ = false;
  NextEventPdf next_event_;                ///< p_nee(x_0): its density as a next event at x_1
  std::array<Edge, 3> joint_;              ///< edges that no walk knows, from the light
  PortalSet::CrossingDensity connection_;  ///< where no walk and no segment knows it
  std::array<VertexFacts, kMaxDepth + 1> places_;
  WalkDensities walks_;
};

}  // namespace tdpt
