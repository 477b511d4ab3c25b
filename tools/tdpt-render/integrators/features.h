// Auxiliary channels (AOVs) for compositors and denoisers: what the camera sees first, and what it
// sees in mirrors and through clear glass. Means over separate rays; the picture's samples are not
// used.
//
// Method: as the manual of Open Image Denoise recommends, rays for albedo and normal go on from
// surfaces that only have Dirac lobes, and so blend what is reflected and what is transmitted by
// Fresnel's equations. Rays split there, and at window panes and veils: by chance, a few rays of
// a pixel would leave noise that a filter takes for texture.
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
/// Position and depth are of the first surface. Albedo and normal are of the first that emits or
/// has more than Dirac lobes; the albedo is multiplied by the colours of those before it. If 16
/// have passed the ray on, or it leaves the scene, the albedo is 0 and the normal that of the
/// first. If only some rays of a pixel hit something, albedo averages over all rays, the other
/// three over those. If none does, all but depth are 0.
inline constexpr std::array kFeatures{"albedo", "normal", "position", "depth"};

/// The channels of those names. A function of the vista and the seed.
Channels features(const Vista& vista, const std::vector<std::string>& names, uint64_t seed);

}  // namespace tdpt
