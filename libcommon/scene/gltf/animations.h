// Animations at time 0. Internal to this room.
//
// Exporters leave the rest pose in the nodes and put what was seen into animations, one for each
// object (Blender 3.4: of an armature that is animated the nodes tell nothing else). So every
// property has the value of the first animation that moves it; a viewer that plays all that go
// together shows the same. No key stands before time 0, and before the first key its value holds:
// at time 0 it is that of the first key, whatever the interpolation.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// Brings translations, rotations, scales and weights of the model's nodes to time 0; `warnings`
/// get a sentence where that is done, or left out. Throws InputError for a channel that is wrong.
void go_to_time_0(Document& document, std::vector<std::string>& warnings);

}  // namespace tdpt::gltf
