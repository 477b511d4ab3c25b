// Rooms in a row with any openings, lamps, doors and furniture, and how they are written: how
// finely split, in which order, how placed in the world.
//
// Plans are in metres, +Y up: rooms stand along +x, the camera in the first, lamps in the last.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt::testing {

/// Counter-clockwise seen from its front.
using Quad = std::array<Vec3d, 4>;

/// A convex opening and the way the light goes through it.
struct KnownAperture {
  std::vector<Vec3d> outline;  ///< corners in the middle of the wall, in order [metres]
  Vec3d normal;                ///< unit
  double thickness = 0;        ///< of the wall [metres]
  /// Beside a leaf: where else all light passes. Its lines cross this outline, too.
  std::vector<Vec3d> mouth{};
  /// What stands in it: bars, slats, furniture. Lines that meet them bring no light.
  std::vector<Quad> obstacles{};
  /// Bars split it into these: a portal for each of them is as right as one over the whole.
  std::vector<KnownAperture> panes{};
  bool optional = false;  ///< may be found, but need not: hardly a bottleneck
};

enum class Splitting { none, in_4, in_144, slivers };

/// Turn about `axis` by `angle`, then scale, then move.
struct Placement {
  Vec3d axis{0, 1, 0};
  double angle = 0;  ///< radians
  double scale = 1;
  Vec3d move{};  ///< metres

  Vec3d turned(const Vec3d& v) const;
  Vec3d operator()(const Vec3d& p) const { return turned(p) * scale + move; }
  KnownAperture operator()(const KnownAperture& aperture) const;
};

/// How a plan is written. Never what it is: the portals of all ways of writing are the same.
struct Writing {
  Splitting splitting = Splitting::none;
  uint64_t shuffle = 0;  ///< not 0: triangles in another order
  double power = 1;      ///< of all lamps
  Placement placement;
};

struct RoomPlan {
  using Quad = testing::Quad;
  struct Part {
    std::string name;
    double radiance = 0;  ///< above 0: a lamp that shines from its front [W/m2/sr]
    std::vector<Quad> quads;
  };
  std::vector<Part> parts;
  Vec3d camera, look_at;
  Vec3d sun{};  ///< unit, towards parallel light; 0: none

  std::string glb(const Writing& writing = {}) const;
};

/// The box between two corners; its faces look outwards. `turn` [radians] about the vertical
/// through `hinge`.
std::vector<RoomPlan::Quad> box(const Vec3d& low, const Vec3d& high, double turn = 0,
                                const Vec3d& hinge = {});

/// Rectangle in a wall across x.
struct WallOpening {
  double y0, y1, z0, z1;
};

/// Both faces of the wall between xa < xb and the jambs of its openings, over the whole y and z
/// extent. `threshold`: whether openings that start at y0 have a floor strip of their own.
std::vector<RoomPlan::Quad> wall_across_x(double xa, double xb, const WallOpening& extent,
                                          const std::vector<WallOpening>& openings, bool threshold);

}  // namespace tdpt::testing
