// Walls and shells of plans, from which known rooms are built.
//
// A wall runs along a line in plan, from corner `a` to corner `b` of its near face. The near face
// looks at the camera's room; with +y up, the far face is on the side of y x (b - a), which is +x
// for a wall along +z. s: metres from `a` along the near face.
#pragma once
#include <vector>

#include "libcommon/testing/rooms/room_plan.h"
#include "libcommon/testing/rooms/room_site.h"

namespace tdpt::testing {

void append(std::vector<Quad>& to, const std::vector<Quad>& quads);

/// One face of a wall: an upright rectangle.
struct Face {
  Vec3d a, b;     ///< lower corners, at y 0
  double s0, s1;  ///< of a and b
  double y0, y1;

  /// Exactly a and b at their s, so that neighbours meet without a crack.
  Vec3d at(double s, double y) const;
};

struct Wall {
  Face near, far;
  Vec3d out;  ///< unit, from the near face to the far face
  double thickness;

  /// A point in the wall, `depth` behind the near face.
  Vec3d at(double s, double y, double depth) const;
};

/// Across x, between two adjacent spaces; each face spans the whole wall of its space. s is z -
/// near.z0.
Wall wall_between(const Space& near, const Space& far);

/// Walls along a polyline (at y 0), mitred where they meet; heights of both sides.
std::vector<Wall> walls_along(const std::vector<Vec3d>& points, double thickness, double near_y0,
                              double near_y1, double far_y0, double far_y1);

/// Both faces and the linings of the openings (z: along s). `threshold`: whether openings that
/// start at the floor have a strip of it.
std::vector<Quad> pierced(const Wall& wall, const std::vector<WallOpening>& openings,
                          bool threshold = true);

/// A wall of the site, and its openings, through which light passes.
void pierce(Site& site, const Wall& wall, const std::vector<WallOpening>& openings);

/// Adjoining openings treated as one: `corners` (s, y, 0) trace their union, counter-clockwise seen
/// from the near side.
std::vector<Quad> pierced_as_one(const Wall& wall, const std::vector<WallOpening>& openings,
                                 const std::vector<Vec3d>& corners);

/// Only the lining of an opening: floor strip, jamb, lintel, jamb.
std::vector<Quad> lining(const Wall& wall, const WallOpening& opening);
std::vector<Quad> lining(const Wall& wall, const std::vector<Vec3d>& corners);

/// Light comes from the far side.
KnownAperture aperture(const Wall& wall, const WallOpening& opening);

/// An opening with a round top: a rectangle of height `springing` above y0, and a semicircle.
struct RoundArch {
  double s0, s1, y0, springing;
  int segments;  ///< of the half-circle

  double radius() const { return 0.5 * (s1 - s0); }
  double top() const { return y0 + springing + radius(); }
  /// Corners (s, y, 0), counter-clockwise seen from the near side: both feet, then the arc.
  std::vector<Vec3d> corners() const;
};
std::vector<Quad> pierced(const Wall& wall, const RoundArch& arch);
KnownAperture aperture(const Wall& wall, const RoundArch& arch);

/// Sides of a space, to be combined.
enum Side : unsigned { kX0 = 1, kX1 = 2, kZ0 = 4, kZ1 = 8, kFloor = 16, kCeiling = 32 };
/// Floor, ceiling and walls of a space, facing inwards, except the sides `open`.
std::vector<Quad> shell(const Space& space, unsigned open);

/// A rectangular face with rectangular holes; `forwards`: its front is on the side of (b - a) x y,
/// that is the near face of a wall.
std::vector<Quad> pierced_face(const Face& face, const std::vector<WallOpening>& holes,
                               bool forwards);

}  // namespace tdpt::testing
