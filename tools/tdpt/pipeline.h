// The way from a scene to a picture: the commands in order, and the cache keys of their results.
#pragma once
#include <string>
#include <vector>

#include "libcommon/options/shot_options.h"
#include "tools/tdpt/cache.h"
#include "tools/tdpt/request.h"

namespace tdpt {

/// Hash of the file at that path; empty if there is none that can be read.
std::string hash_at(const std::string& path);

/// The inputs of a picture by content: the scene with all files it reads, the sky, given portals.
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

/// The search for the portals of a picture, or of some frames of a shot.
struct Search {
  std::string entry;         ///< of the work folder
  std::vector<Step> stages;  ///< at least one
  FrameRange frames{};
  const std::string& found() const { return stages.back().output; }
};

/// A frame of a shot that is filtered with those beside it.
struct FilteredFrame {
  int64_t number = 0;
  std::string picture, key;  ///< path; hash of everything that affects its file
  Words command;             ///< of exrdenoise, but for -o
};

struct Pipeline {
  std::string entry;             ///< of the work folder, for the picture's film, or its frames
  std::vector<Search> searches;  ///< none if no portals are sought
  /// Of a shot with several searches: the pattern of the frames' portals, in the picture's entry.
  std::string portals_by_frame;
  Step render;
  std::vector<FilteredFrame> filtered;  ///< not empty: `render` makes what they are filtered from,
  std::string noisy;                    ///< in this folder of the picture's entry
  Words check;       ///< the renderer's check of all files that exist before the stages
  std::string key;   ///< of the picture: hash of everything that affects its file
  std::string film;  ///< path of its film, with which the next run goes on; empty: none is kept
  std::string shared_film;  ///< to which all commands go on that say a number of samples or seconds
  bool repeatable = true;   ///< running the same command again does nothing
};

Pipeline pipeline_of(const Arguments& a, const cli::Common& common, const Request& request,
                     const SceneState& state, const Cache& cache);

/// The renderer's command for some frames of the shot.
Words command_for(const Step& render, const FrameRange& frames);

/// Those frames and the ones beside them, of a shot with these: as runs of consecutive numbers.
std::vector<FrameRange> with_those_beside(const std::vector<FilteredFrame>& frames,
                                          const FrameRange& all);

/// Quoted for a shell.
std::string shell_text(const Words& words);

}  // namespace tdpt
