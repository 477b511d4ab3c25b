// What the command line of tdpt-render says; tdpt-render(1) tells what it means.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/formats/render_options.h"

namespace tdpt {

struct Arguments : RenderArguments {
  std::string plan;   ///< a path; empty: not given
  std::string shard;  ///< "I/N" or "all/N"; empty: not given
  bool check = false;
};

/// The names of --aov, each once, in the order of kFeatures and kDerived. Throws UsageError for one
/// that there is not.
std::vector<std::string> aovs_of(const Arguments& a);

/// --shard all/N: prints commands, and renders nothing.
bool prints_shards(const Arguments& a);

/// Whether --plan names a plan to obey, and not one to write: for a shard, and for a picture
/// (`output_given`) where it is there.
bool obeys_plan(const Arguments& a, bool output_given);
/// Whether a plan is written, and no picture rendered.
bool only_plans(const Arguments& a, bool output_given);

/// The options of the program, which fill in `a`.
void declare_options(cli::Options& options, Arguments& a);

}  // namespace tdpt
