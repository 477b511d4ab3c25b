// Rendering defaults in the extras of a glTF scene: keys that begin with tdpt_, flat, so that they
// can be typed as custom properties of a scene in a modelling program [gltf-scene(5)].
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "libcommon/scene/scene_defaults.h"

namespace tdpt {

/// Those of the default scene. `gltf`: the JSON of the file, checked or not; malformed parts are
/// ignored. `file`: its path, "-" for standard input; files that the scene names are looked up
/// beside it. Throws InputError for a value of the wrong type or out of range.
SceneDefaults defaults_of(const nlohmann::json& gltf, const std::string& file);

}  // namespace tdpt
