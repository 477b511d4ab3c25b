// Lists the files of a scene without reading it further, for programs that check whether it has
// changed.
#pragma once
#include <string>
#include <vector>

namespace tdpt {

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
