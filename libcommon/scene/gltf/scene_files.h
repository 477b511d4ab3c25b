// Which files a scene is made of, for programs that ask whether it has changed and read it no
// further.
#pragma once
#include <string>
#include <vector>

namespace tdpt {

struct SceneFiles {
  /// Names of those that it reads beside itself, buffers, images, profiles of luminaires and the
  /// environment of its extras, each once, as paths from its folder; whether they are there or not,
  /// and may be read.
  std::vector<std::string> beside;
  bool has_environment = false;  ///< its extras say what shines from all around
};

/// By a look at the JSON of a glTF scene alone: one that is wrong has none, and its readers say
/// why. Throws InputError where the file itself cannot be read.
SceneFiles files_of_scene(const std::string& path);

}  // namespace tdpt
