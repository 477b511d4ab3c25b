// Applies animations: the pose of the nodes at a time (glTF 2.0, section 3.11 and appendix C).
// Internal to this room.
//
// Exporters leave the rest pose in the nodes and put what the user saw into animations, one per
// object (Blender 3.4: the nodes of an animated armature hold nothing else). So each property takes
// its value from the first animation that moves it, as in a viewer that plays all animations that
// belong together. Before its first key and after its last it holds their values.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// What the animations of a file move.
struct Motion {
  bool moves = false;  ///< some node
  std::vector<AnimationFacts> animations;
};

/// Sets translations, rotations, scales and weights of the nodes to their values at a time
/// [s]. May be repeated for other times. Throws InputError for a malformed channel.
Motion go_to(Document& document, double seconds);

}  // namespace tdpt::gltf
