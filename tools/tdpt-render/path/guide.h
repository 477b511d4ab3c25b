// Walks that are directed at portals: at each vertex on the side a walk begins on, its next
// direction is drawn towards a point on a portal with some probability q, and by the surface's own
// sampling otherwise.
//
// With p(w) the density of the surface's own sampling and a(w) that of aiming (portals.h),
//   guided  pdf_w = (1-q) p(w) + q m a(w),
// m the probability that no Dirac lobe was tried: those lobes are left as they are. Where p = 0
// nothing is scattered, and the walk ends.
//
// Only a share f of the walks of either kind is directed, the others are plain. A prefix
// x_0 ... x_n then has the density
//   f prod P_guided(x_i) + (1-f) prod P_plain(x_i) = prod P_guided(x_i) * (f + (1-f) r),
//   r = prod P_plain(x_i) / P_guided(x_i),
// whichever kind of walk made it: throughputs and weights are those of this mixture.
#pragma once
#include "tools/tdpt-render/path/vertex.h"
#include "tools/tdpt-render/path/world.h"

namespace tdpt {

/// How the walks of an integrator are directed; indices: From.
struct Guiding {
  std::array<double, 2> chance{};         ///< q
  std::array<double, 2> share{1.0, 1.0};  ///< f; more than 0
  friend bool operator==(const Guiding&, const Guiding&) = default;
};

class Guide {
 public:
  Guide(const World& world, const Guiding& guiding)
      : portals_(world.portals),
        guiding_(guiding),
        active_(!world.portals.empty() && (guiding.chance[0] > 0 || guiding.chance[1] > 0)) {}

  /// Whether any walk is directed; otherwise `crossing` knows D alone and the rest is not called.
  bool active() const { return active_; }

  /// Of an edge `a` -> `b`, a nearer to the light on its path. `drawn`: as in portals.h.
  PortalSet::Crossing crossing(const Vertex& a, const Vertex& b,
                               const PortalSet::Drawn& drawn = {}) const;

  /// Tells a surface that is seen along unit `away` from it, or was left along it, how walks are
  /// directed there.
  void aim_at_surface(const Vec3d& away, Vertex& v) const;
  /// Tells y_0, a place on a light.
  void aim_at_light(Vertex& v) const;

  /// Whether a walk that has `aim` at `v` is directed, and then the direction and the triangle
  /// aimed at. `u`: as in PortalSet::aim, and whether.
  bool draw(const Vertex& v, const Aim& aim, From from, const std::array<double, 4>& u, Vec3d& w,
            int& triangle) const;

  /// Of a walk at `at` that came from unit `back` (0: it begins there) and reaches `to`: the guided
  /// density [1/canonical area], from the plain one and the edge's crossing.
  double pdf_A(From from, const Vertex& at, const Vec3d& back, const Vertex& to, double plain_A,
               const PortalSet::Crossing& crossing) const;

  /// f of walks from there.
  double share(From from) const { return guiding_.share[static_cast<size_t>(from)]; }
  /// f + (1-f) r.
  double mixture(From from, double r) const { return share(from) + (1 - share(from)) * r; }

 private:
  Aim aim(const Vertex& v, const Vec3d& facing, From from) const;

  const PortalSet& portals_;
  Guiding guiding_;
  bool active_;
};

}  // namespace tdpt
