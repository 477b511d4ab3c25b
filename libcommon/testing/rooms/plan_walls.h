// Walls and shells of plans, from which known rooms are built.
//
// A wall stands along a line in plan, from the corner `a` to the corner `b` of its near face. The
// near face looks at the camera's room; with +y up, the far face lies at the side of y x (b - a),
// which is +x for a wall along +z. s: metres from `a` along the near face.
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
  Vec3d out;  ///< unit, from the near face to the far one
  double thickness;

  /// A place within the wall, `depth` behind the near face.
  Vec3d at(double s, double y, double depth) const;
};

/// Across x, between two spaces in a row; each face is the whole wall of its space. s is z -
/// near.z0.
Wall wall_between(const Space& near, const Space& far);

/// Walls along a line of points (at y 0), mitred where they meet; heights of both sides.
std::vector<Wall> walls_along(const std::vector<Vec3d>& points, double thickness, double near_y0,
                              double near_y1, double far_y0, double far_y1);

/// Both faces and the linings of the openings (z: along s).
std::vector<Quad> pierced(const Wall& wall, const std::vector<WallOpening>& openings);

/// Openings that touch, as one: `corners` (s, y, 0) go round their union, counter-clockwise seen
/// from the near side.
std::vector<Quad> pierced_as_one(const Wall& wall, const std::vector<WallOpening>& openings,
                                 const std::vector<Vec3d>& corners);

/// The lining of an opening alone: floor strip, lintel, jambs.
std::vector<Quad> lining(const Wall& wall, const WallOpening& opening);
std::vector<Quad> lining(const Wall& wall, const std::vector<Vec3d>& corners);

/// Light comes from the far side.
KnownAperture aperture(const Wall& wall, const WallOpening& opening);

/// An opening with a round top: a rectangle of height `springing` above y0, and half a disc.
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

/// Sides of a space, to be added up.
enum Side : unsigned { kX0 = 1, kX1 = 2, kZ0 = 4, kZ1 = 8, kFloor = 16, kCeiling = 32 };
/// Floor, ceiling and walls of a space, looking inwards, but for the sides `open`.
std::vector<Quad> shell(const Space& space, unsigned open);

/// A rectangular face with rectangular holes; `forwards`: its front is at the side of
/// (b - a) x y, that is the near one of a wall.
std::vector<Quad> pierced_face(const Face& face, const std::vector<WallOpening>& holes,
                               bool forwards);

}  // namespace tdpt::testing
