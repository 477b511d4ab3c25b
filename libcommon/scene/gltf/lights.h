// KHR_lights_punctual, EXT_lights_ies and EXT_lights_area (a draft: KhronosGroup/glTF, pull request
// 2525). Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Upper bound on the vertices and on the triangles of an area light.
constexpr size_t kMostOfAreaLight = 65;

/// Adds the lights of visible nodes: punctual ones and luminaires, still in metres (position [m],
/// intensity of points and spots [W/sr]), and area lights, with their vertices [m], as materials
/// and triangles of their own. Lights that emit nothing are passed over; profiles in files beside
/// the scene are listed in scene.files and change its hash. Throws InputError, for lights that no
/// node holds, too.
void read_lights(const Document& document, const PlacedNodes& nodes, Scene& scene,
                 std::vector<Vec3d>& world, Notes& notes);

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
