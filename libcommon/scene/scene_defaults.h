// What a scene says for those who render it, where the command line does not: the picture's size,
// its camera and what shines from all around.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/error.h"

namespace tdpt {

struct SceneDefaults {
  std::string place;  ///< where the file has them, "scenes[0].extras"

  std::string environment;       ///< a file's name, "R,G,B" [W/m2/sr] or "none"; empty: not said
  std::string environment_file;  ///< path of that file; empty: it is none, or cannot be read
  /// Why it cannot be read, an error only for those who take it; null: nothing is wrong.
  std::shared_ptr<const InputError> environment_fault{};
  std::optional<double> rotation, scale;  ///< of that environment: [deg], factor

  int width = 0, height = 0;  ///< pixels; 0: not said
  std::string camera;         ///< the name of one; empty: not said

  std::vector<std::string> warnings;  ///< sentences: what of it means nothing

  /// Whether what shines from all around is said, and is not nothing.
  bool has_environment() const { return !environment.empty() && environment != "none"; }
  std::string place_of(const char* key) const { return place + "." + key; }
};

}  // namespace tdpt
