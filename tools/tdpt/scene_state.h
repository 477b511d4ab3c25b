// What a picture is made from, by content: the scene with all that it reads, the sky, portals that
// are given.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt/request.h"
#include "tools/tdpt/work_folder.h"

namespace tdpt {

struct SceneState {
  std::string hash;  ///< of the scene and the files that it reads
  std::string sky;   ///< of the environment that the command line names; empty: no file
  std::vector<std::string> portals;  ///< hashes of files that are given, or drawn beside the scene
  std::string drawn;                 ///< path of those that are drawn beside it; empty: none
  std::vector<std::string> files;    ///< paths of all that there is of these
  bool has_sky = false;              ///< named by the scene
  friend bool operator==(const SceneState&, const SceneState&) = default;
};

/// Reads every byte, and nothing else: a scene that is wrong has a state, too. Which files it names
/// is kept in `work`. Throws InputError where the scene cannot be read.
SceneState state_of(const Arguments& a, const WorkFolder& work);

}  // namespace tdpt
