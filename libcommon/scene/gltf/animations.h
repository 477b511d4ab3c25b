// Applies animations at time 0. Internal to this room.
//
// Exporters leave the rest pose in the nodes and put what the user saw into animations, one per
// object (Blender 3.4: the nodes of an animated armature hold nothing else). So each property takes
// its value from the first animation that moves it, as in a viewer that plays all animations that
// belong together. No key lies before time 0, and the value before the first key is that of the
// first key: so it is the value at time 0, whatever the interpolation.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// Sets translations, rotations, scales and weights of the model's nodes to time 0; adds a sentence
/// to `warnings` if that changes something or an animation is ignored. Throws InputError for a
/// malformed channel.
void go_to_time_0(Document& document, std::vector<std::string>& warnings);

}  // namespace tdpt::gltf
