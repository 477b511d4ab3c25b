// Crossings of light lines with a plane, and their passage through the slab between two parallel
// planes.
//
// Symbols: o a point in the plane, n its unit normal, the way the light goes, (u, v) coordinates in
// the plane along the axes of Onb(n); all lengths in metres.
#pragma once
#include <algorithm>
#include <optional>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/limits.h"
#include "tools/portalfit/polygon.h"

namespace tdpt {

struct Plane {
  Vec3d o, n;
};

/// The slab between the planes `half` before and `half` behind `middle`; with an outline in the
/// middle it is a tube, the prism that an opening cuts into its wall.
struct Tube {
  Plane middle;
  double half = 0;
};

/// A line relative to a slab: it starts at height `from` above the middle and rises by `along` > 0.
struct Passage {
  double from, along;
  Vec2d start, way;  ///< of the whole line, projected into the middle plane

  /// Its point nearest to the height `offset`, projected: where it passes there, or its end before
  /// that, as on a jamb.
  Vec2d at(double offset) const {
    return start + way * std::clamp((offset - from) / along, 0.0, 1.0);
  }
  /// Whether it passes both faces of a slab of this half thickness.
  bool through(double half) const { return from <= -half && from + along >= half; }
};

/// A slab with its frame, for processing many lines.
class Slab {
 public:
  explicit Slab(const Tube& tube) : tube_(tube), frame_(tube.middle.n) {}

  /// Nothing if the line stays outside or does not run along the normal.
  std::optional<Passage> passage(const LightLine& line) const {
    const Vec3d a = line.light - tube_.middle.o, d = line.camera - line.light;
    const double from = dot(a, tube_.middle.n), along = dot(d, tube_.middle.n);
    if (!(along > 0) || from > tube_.half || from + along < -tube_.half) return {};
    return Passage{
        from, along, {dot(a, frame_.x), dot(a, frame_.y)}, {dot(d, frame_.x), dot(d, frame_.y)}};
  }

 private:
  Tube tube_;
  Onb<double> frame_;
};

/// Where `line` crosses the plane along n.
std::optional<Vec2d> crossing(const Plane& plane, const LightLine& line);
/// The same, but nothing at grazing angles, where the crossing is ill-defined.
std::optional<Vec2d> clear_crossing(const Plane& plane, const LightLine& line,
                                    const FitLimits& limits);
/// The point of `line` inside the slab nearest to the height `offset` above the middle: see
/// Passage::at.
std::optional<Vec2d> inside_at(const Tube& tube, const LightLine& line, double offset);

Vec3d to_space(const Plane& plane, Vec2d at);
/// The inverse, for the foot of the perpendicular from `place`.
Vec2d in_plane(const Plane& plane, const Vec3d& place);

}  // namespace tdpt
