// The command line of tdpt-render; tdpt-render(1) explains the options.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/options/render_options.h"

namespace tdpt {

struct Arguments : RenderArguments {
  std::string plan;   ///< a path; empty: not given
  std::string shard;  ///< "I/N" or "all/N"; empty: not given
  bool check = false;
  /// Set for one frame of a shot [shot.h]: its number; none: a picture of its own.
  std::optional<int64_t> frame{};
  /// "frame 7: ", before what is told of it; nothing for a picture of its own.
  std::string of_frame() const { return frame ? "frame " + std::to_string(*frame) + ": " : ""; }
  /// Of a frame: the first of those whose samples it has; they have its seed. Its own with
  /// --accumulate off, or once something has moved.
  int64_t since = 0;
  /// As many times the samples of one frame.
  uint64_t frames_held() const { return frame ? static_cast<uint64_t>(*frame - since) + 1 : 1; }
  bool portals_by_frame = false;  ///< each frame of the shot has portal files of its own
};

/// The names of --aov, each once, in the order of kFeatures and kDerived. Throws UsageError for an
/// unknown one.
std::vector<std::string> aovs_of(const Arguments& a);
/// Whether some of them need the halves of the film.
bool keeps_halves(const Arguments& a);

/// --shard all/N: only prints commands.
bool prints_shards(const Arguments& a);

/// Whether --plan names a plan to obey rather than to write: always for a shard; for a picture
/// (`output_given`) if the file exists.
bool obeys_plan(const Arguments& a, bool output_given);
/// Whether a plan is written and no picture rendered.
bool only_plans(const Arguments& a, bool output_given);

/// Declares the program's options, which fill in `a`.
void declare_options(cli::Options& options, Arguments& a);

}  // namespace tdpt
