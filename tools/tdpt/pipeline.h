// The way from a scene to a picture: the commands, in order, and the keys of what they make.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt/request.h"
#include "tools/tdpt/scene_state.h"
#include "tools/tdpt/work_folder.h"

namespace tdpt {

/// A program, and what it makes.
struct Step {
  std::string title;   ///< "finding bottlenecks", while it runs
  Words options;       ///< the program and what shapes its result
  Words inputs;        ///< files
  Words unshaped;      ///< options that shape nothing
  std::string output;  ///< path of its result
  /// All of it, with the result under that name.
  Words command(const std::string& to) const;
};

struct Pipeline {
  /// Names of entries of the work folder: for the portals, empty where no stage is to find them;
  /// for what a picture leaves unfinished.
  std::string portals_entry, picture_entry;
  std::vector<Step> stages;  ///< to the portals; none where none are to be found
  Step render;
  Words check;              ///< the same, of what is there before the stages, without rendering
  std::string key;          ///< of the picture: hash of all that shapes it
  bool keeps_film = false;  ///< for the next run, where this one is stopped
  bool repeatable = true;   ///< the same command again has nothing to do
};

/// `programs`: their folder.
Pipeline pipeline_of(const Arguments& a, const Request& request, const SceneState& state,
                     const WorkFolder& work, const std::string& programs);

/// For a shell, each word as it is.
std::string shell_text(const Words& words);

}  // namespace tdpt
