// The inputs of a picture by content: the scene with all files it reads, the sky, given portals.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt/request.h"

namespace tdpt {

struct SceneState {
  std::string hash;                  ///< of the scene and its files
  std::string sky;                   ///< of the environment named on the command line; empty: none
  std::vector<std::string> portals;  ///< hashes of portal files, given or drawn beside the scene
  std::string drawn;                 ///< path of those drawn beside it; empty: none
  std::vector<std::string> files;    ///< paths of all of these that exist
  bool has_sky = false;              ///< the scene names one
  friend bool operator==(const SceneState&, const SceneState&) = default;
};

/// Only hashes bytes, so an invalid scene has a state too. Throws InputError if the scene cannot be
/// read.
SceneState state_of(const Arguments& a);

}  // namespace tdpt
