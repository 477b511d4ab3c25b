// What a scene's JSON alone tells: rendering defaults in the extras of its scene, and the files
// that it names.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Those of the default scene. `gltf`: the JSON of the file. `file`: its path, "-" for standard
/// input; files that the scene names are looked up beside it. Throws InputError for a value of the
/// wrong type or out of range.
SceneDefaults defaults_of(const nlohmann::json& gltf, const std::string& file);

constexpr double kBrightestSky = 1e30, kFaintestSky = 1e-30;  // [W/m2/sr]

/// Whether the text is meant as a colour, even a malformed one, and not as a file name: it has
/// commas and is no path, or it is a number.
bool means_colour(const std::string& text);

/// A uniform sky, "R,G,B" [W/m2/sr]; if it is malformed, `expected` says what is expected.
std::optional<Rgb> parse_colour(const std::string& text, std::string& expected);

struct SceneFiles {
  /// Files that the scene refers to (buffers, images, profiles of luminaires, the environment in
  /// its extras), each once, as paths relative to its folder, whether or not they exist or may be
  /// read.
  std::vector<std::string> beside;
  bool has_environment = false;  ///< its extras name an environment
};

/// Looks at the JSON of a glTF scene only. A malformed scene gives an empty list; readers report
/// the error. Throws InputError if the file itself cannot be read.
SceneFiles files_of_scene(const std::string& path);

}  // namespace tdpt
