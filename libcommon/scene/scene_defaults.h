// Rendering defaults stored in a scene and used unless the command line says otherwise: picture
// size, camera and environment.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/error.h"

namespace tdpt {

struct SceneDefaults {
  std::string place;  ///< where the file sets them, "scenes[0].extras"

  std::string environment;       ///< a file's name, "R,G,B" [W/m2/sr] or "none"; empty: not set
  std::string environment_file;  ///< path of that file; empty: no file, or not readable
  /// Why it cannot be read; thrown only when it is used. Null: no error.
  std::shared_ptr<const InputError> environment_fault{};
  std::optional<double> rotation, scale;  ///< of that environment: [deg], factor

  int width = 0, height = 0;  ///< pixels; 0: not set
  std::string camera;         ///< a camera's name; empty: not set

  std::vector<std::string> warnings;  ///< sentences: settings that are ignored

  /// Whether an environment is set, other than "none".
  bool has_environment() const { return !environment.empty() && environment != "none"; }
  std::string place_of(const char* key) const { return place + "." + key; }
};

}  // namespace tdpt
