// Shared by all generated rooms: random numbers in a fixed order, lamps, furniture, the camera, and
// how the plan is written.
#pragma once
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libcommon/math/rng.h"
#include "libcommon/testing/rooms/known_rooms.h"

namespace tdpt::testing {

inline constexpr double kDegree = std::numbers::pi / 180;

/// An upright box of air.
struct Space {
  double x0, x1, y0, y1, z0, z1;
  double height() const { return y1 - y0; }
  double depth() const { return z1 - z0; }
  double middle_z() const { return 0.5 * (z0 + z1); }
};

/// A room under construction. Light travels towards -x, from the lamps' space to the camera's.
class Site {
 public:
  Site(RoomKind kind, uint64_t seed);

  double between(double low, double high) { return low + (high - low) * rng_.uniform(); }
  /// Log-uniform in [low, high].
  double log_between(double low, double high) { return low * std::pow(high / low, rng_.uniform()); }
  /// Uniform in low, low + 1, ... high.
  int count_between(int low, int high) {
    return low + static_cast<int>(rng_.below(static_cast<uint32_t>(high - low + 1)));
  }
  bool chance(double probability) { return rng_.uniform() < probability; }

  void part(const std::string& name, std::vector<Quad> quads, double radiance = 0);
  void opening(KnownAperture aperture);

  /// One lamp or several. `beside_opening`: they may be aimed away from the wall at x0.
  void lamps(const Space& space, bool beside_opening = true);
  /// A lamp placed by the builder; `how` it shines, one word.
  void lamp(const std::string& how, const Quad& quad, double radiance);
  /// Light from infinity. `sun`: unit, towards it, 0: none; `sky`: uniform radiance.
  void daylight(const std::string& what, const Vec3d& sun, const Vec3d& sky);
  /// Whether a box stands within `free` of the wall in front of one of the non-optional openings so
  /// far, on the side that the light goes to.
  bool before_opening(const Vec3d& low, const Vec3d& high, double free) const;
  /// Obstacles in the opening added last.
  void obstacles_of_last(const std::vector<Quad>& quads);
  /// Boxes on the floor, lower than cameras and lamps, away from the walls across x.
  void furniture(const Space& space);
  void camera(const Space& space);
  /// The finished room, mirrored in half of the cases, with a random way of writing it.
  KnownRoom finish();

 private:
  void lamp(const std::string& how, double radiance, const Space& space, bool beside_opening);
  void mirror();
  void choose_writing();

  Rng rng_;
  KnownRoom room_;
};

/// Up to eight tables, chairs, shelves and boxes on the floor, lower than cameras and lamps, away
/// from the walls across x and from the openings so far; none if there is no space.
void furnish(Site& site, const Space& space);

}  // namespace tdpt::testing
