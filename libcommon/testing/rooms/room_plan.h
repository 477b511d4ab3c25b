// Rooms in a row with openings, lamps, doors and furniture, and how they are written: tessellation,
// order, placement in the world.
//
// Plans are in metres, +Y up: rooms are arranged along +x, the camera in the first, lamps in the
// last.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt::testing {

/// Counter-clockwise seen from its front.
using Quad = std::array<Vec3d, 4>;

/// A convex opening and the direction in which light passes it.
struct KnownAperture {
  std::vector<Vec3d> outline;  ///< corners in order, in the middle of the wall [metres]
  Vec3d normal;                ///< unit
  double thickness = 0;        ///< of the wall [metres]
  /// Beside a door leaf: a second outline that all light passes. The opening's lines cross it, too.
  std::vector<Vec3d> mouth{};
  /// Obstacles in it: bars, slats, furniture. Lines that they block bring no light.
  std::vector<Quad> obstacles{};
  /// The panes into which bars split it: one portal per pane is as right as one over the whole.
  std::vector<KnownAperture> panes{};
  bool optional = false;  ///< may or may not be found: hardly a bottleneck
};

enum class Splitting { none, in_4, in_144, slivers };

/// Rotation by `angle` about `axis`, then scale, then translation.
struct Placement {
  Vec3d axis{0, 1, 0};
  double angle = 0;  ///< radians
  double scale = 1;
  Vec3d move{};  ///< metres

  Vec3d turned(const Vec3d& v) const;
  Vec3d operator()(const Vec3d& p) const { return turned(p) * scale + move; }
  KnownAperture operator()(const KnownAperture& aperture) const;
};

/// How a plan is written, not what it contains: all ways of writing must give the same portals.
struct Writing {
  Splitting splitting = Splitting::none;
  uint64_t shuffle = 0;  ///< not 0: shuffles the triangles
  double power = 1;      ///< factor on the power of all lamps
  Placement placement;
};

struct RoomPlan {
  using Quad = testing::Quad;
  /// Grey board; glass as one sheet for each pane, or as closed bodies; cloth that half of the
  /// light passes.
  enum class Stuff { board, sheet, glass, cloth };
  struct Part {
    std::string name;
    double radiance = 0;  ///< above 0: a lamp that emits on its front [W/m2/sr]
    std::vector<Quad> quads;
    Stuff stuff = Stuff::board;
  };
  std::vector<Part> parts;
  Vec3d camera, look_at;
  Vec3d sun{};  ///< unit, towards parallel light; 0: none

  std::string glb(const Writing& writing = {}) const;
};

/// The box between two corners, facing outwards, rotated by `turn` [radians] about the vertical
/// axis through `hinge`.
std::vector<RoomPlan::Quad> box(const Vec3d& low, const Vec3d& high, double turn = 0,
                                const Vec3d& hinge = {});

/// A rectangle in a wall across x.
struct WallOpening {
  double y0, y1, z0, z1;
};

}  // namespace tdpt::testing
