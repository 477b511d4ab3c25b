// What the extras of a glTF scene say for those who render it: keys that begin with tdpt_, flat, so
// that they can be typed as custom properties of a scene in a modelling program [gltf-scene(5)].
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "libcommon/scene/scene_defaults.h"

namespace tdpt {

/// Those of the scene that is shown. `gltf`: the JSON of the file, checked or not; what is no scene
/// says nothing. `file`: its path, "-" for standard input, beside which a file that it names is
/// looked for. Throws InputError for a value of the wrong type or out of its range.
SceneDefaults defaults_of(const nlohmann::json& gltf, const std::string& file);

}  // namespace tdpt
