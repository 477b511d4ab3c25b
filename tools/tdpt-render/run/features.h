// What compositors and denoisers want to know of a picture beside its light: what the camera sees
// first. Means over rays of their own, which end at the first surface, mirrors and glass among
// them: no sample of the picture has a part in them.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/formats/picture.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// albedo.R .G .B      share of white light from the camera's side that is scattered, [0,1]
/// normal.X .Y .Z      shading normal on that side; its length is less than 1 where normals mix
/// position.X .Y .Z    [m]
/// depth.Z             along the camera's axis [m]; 1e10 where nothing is met
/// Where some rays meet nothing the last three are of the others, albedo is not; where none meets
/// anything all but depth are 0.
inline constexpr std::array kFeatures{"albedo", "normal", "position", "depth"};

/// Those of that name. A function of the world and the seed.
Channels features(const World& world, const std::vector<std::string>& names, uint64_t seed);

}  // namespace tdpt
