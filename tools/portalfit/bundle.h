// A bundle of light lines that pass one aperture, and the plane of its waist: where a beam has
// least area.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

/// The densest place of `lines` (indices into grid.lines): centre of the fullest voxel, metres.
Vec3d fullest_place(const LightGrid& grid, const std::vector<uint32_t>& lines);

/// Mean direction of the lines that pass within `radius` of `place`; zero when there are none.
Vec3d mean_direction_near(const LightGrid& grid, const std::vector<uint32_t>& lines,
                          const Vec3d& place, double radius);

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
