// A bundle of light lines that pass one aperture, and the plane of its waist.
//
// Symbols: n normal (the way the light goes), o a place in the plane, (u, v) coordinates in the
// plane along the axes of Onb(n).
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/polygon.h"

namespace tdpt {

struct Plane {
  Vec3d o, n;
};

/// The prism between the planes half in front of and half behind `middle` [metres].
struct Tube {
  Plane middle;
  double half = 0;
};

/// Where `line` crosses the plane along n, in plane coordinates; false when it does not, or only
/// at a grazing angle.
bool crossing(const Plane& plane, const LightLine& line, Vec2d& at);
/// Where `line` is nearest to the plane `offset` behind the middle while inside the tube's two
/// planes, in coordinates of the plane: the crossing, or the line's end where it ends inside, as on
/// a jamb. False when the line stays outside or runs against the normal.
bool inside_at(const Tube& tube, const LightLine& line, double offset, Vec2d& at);
Vec3d to_space(const Plane& plane, Vec2d at);

/// The densest place of `lines` (indices into grid.lines): centre of the fullest voxel, metres.
Vec3d fullest_place(const LightGrid& grid, const std::vector<uint32_t>& lines);

/// Mean direction of the lines that pass within `radius` of `place`; zero when there are none.
Vec3d mean_direction_near(const LightGrid& grid, const std::vector<uint32_t>& lines,
                          const Vec3d& place, double radius);

/// A rectangle with the second moments of points spread evenly over it.
struct Extents {
  Vec2d mean, axis;  ///< of the longer side
  double longer = 0, shorter = 0;
};
Extents extents_of(const std::vector<Vec2d>& points);

/// Those of `lines` that pass the middle of the tube within the connected dense region around its
/// `o`. `h` is the size of the first look [metres].
std::vector<uint32_t> members(const LightGrid& grid, const std::vector<uint32_t>& lines,
                              const Tube& tube, double h);

/// The plane near `start` that the lines cross within the smallest area: the waist of the bundle.
/// Strays are left out; planes that fewer lines cross are held back. In a thick wall, its middle.
/// The area is that of the moments (square root of their determinant): quick and without local
/// minima, but biased where light comes from one side.
Plane waist(const LightGrid& grid, const std::vector<uint32_t>& lines, const Plane& start);

}  // namespace tdpt
