// Bins of directions in which the tools that find portals see light from infinity: sky, suns and
// parallel light.
//
// Method: the faces of an icosahedron, each split in four, projected onto the sphere: 80 spherical
// triangles of 0.15 to 0.18 sr, about 26 degrees wide.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

inline constexpr uint32_t kSkyBins = 80;

/// Corners of a bin, unit; counter-clockwise seen from the middle of the sphere.
const std::array<Vec3d, 3>& sky_bin_corners(uint32_t bin);
/// The middle of a bin, unit.
Vec3d sky_bin_middle(uint32_t bin);
/// [sr]
double sky_bin_solid_angle(uint32_t bin);
/// The bin that contains a direction (of any length but 0).
uint32_t sky_bin(const Vec3d& towards);

/// Whether there is light from infinity: a sky that is not black, or parallel light.
bool lit_from_infinity(const Scene& scene);
/// Luminance of each bin's light, integrated over its directions [W/m2].
std::vector<double> sky_bin_light(const Scene& scene);

}  // namespace tdpt
