// The way from a scene to a picture: the commands in order, and the cache keys of their results.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt/request.h"
#include "tools/tdpt/scene_state.h"
#include "tools/tdpt/work_folder.h"

namespace tdpt {

/// A program and its result.
struct Step {
  std::string title;   ///< "finding bottlenecks", shown while it runs
  Words options;       ///< the program, and options that affect its result
  Words inputs;        ///< files
  Words unshaped;      ///< options that do not affect the result
  std::string output;  ///< path of its result
  /// The whole command, with `to` as the path of its result.
  Words command(const std::string& to) const;
};

struct Pipeline {
  /// Names of entries of the work folder: for the portals, empty if no stage is to find them; for
  /// an unfinished picture.
  std::string portals_entry, picture_entry;
  std::vector<Step> stages;  ///< that find portals; none if none are sought
  Step render;
  Words check;              ///< the renderer's check of all files that exist before the stages
  std::string key;          ///< of the picture: hash of everything that affects it
  bool keeps_film = false;  ///< so that the next run can resume it
  bool repeatable = true;   ///< running the same command again does nothing
};

/// `programs`: the folder with the programs.
Pipeline pipeline_of(const Arguments& a, const Request& request, const SceneState& state,
                     const WorkFolder& work, const std::string& programs);

/// Quoted for a shell.
std::string shell_text(const Words& words);

}  // namespace tdpt
