// Auxiliary channels (AOVs) for compositors and denoisers: what the camera sees first. Means over
// separate rays, which end at the first surface, mirrors and glass included; the picture's samples
// are not used.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/formats/picture.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// albedo.R .G .B      share of white light from the camera's side that is scattered, [0,1]
/// normal.X .Y .Z      shading normal on that side; shorter than 1 where normals are averaged
/// position.X .Y .Z    [m]
/// depth.Z             along the camera's axis [m]; 1e10 where nothing is hit
/// If only some rays of a pixel hit something, albedo averages over all rays, the other three over
/// those. If none does, all but depth are 0.
inline constexpr std::array kFeatures{"albedo", "normal", "position", "depth"};

/// The channels of those names. A function of the world and the seed.
Channels features(const World& world, const std::vector<std::string>& names, uint64_t seed);

}  // namespace tdpt
