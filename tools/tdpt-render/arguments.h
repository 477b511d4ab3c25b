// What the command line of tdpt-render says; tdpt-render(1) tells what it means.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/formats/camera_options.h"
#include "libcommon/formats/sky_options.h"

namespace tdpt {

namespace cli {
class Options;
}

struct Arguments {
  std::string scene, device;
  std::vector<std::string> portals;
  SkyArguments sky;
  CameraArguments camera;
  int64_t width = 0, height = 0;  ///< pixels; 0: not given

  std::string integrator = "auto", mis = "balance";
  double guide_light = -1, guide_camera = -1, segments = -1,
         light_walks = -1;  ///< below 0: not given
  int64_t spp = 0;
  int64_t max_depth = 0;    ///< edges; 0: no limit
  double seconds = 0;       ///< 0: no limit
  double target_error = 0;  ///< relMSE; 0: none
  bool retry = false;

  std::string checkpoint, resume, plan;  ///< paths; empty: not given
  double checkpoint_every = -1;          ///< seconds; below 0: not given
  int64_t add_samples = 0;
  std::string shard;         ///< "I/N"; empty: not given
  int64_t print_shards = 0;  ///< N; 0: not given
  std::string isa = "native";

  std::string stats, nonzero, preview;  ///< paths; empty: not asked for
  bool layers = false, alpha = false;
  std::string aov;  ///< names, separated by commas
};

/// The names of --aov, each once, in the order of kFeatures and kDerived. Throws UsageError for one
/// that there is not.
std::vector<std::string> aovs_of(const Arguments& a);

/// Whether --plan names a plan to obey, and not one to write: for a shard, and for a picture
/// (`output_given`) where it is there.
bool obeys_plan(const Arguments& a, bool output_given);
/// Whether a plan is written, and no picture rendered.
bool only_plans(const Arguments& a, bool output_given);

/// Throws UsageError for what is wrong with options whatever the files hold.
void check_arguments(const Arguments& a);

/// The options of the program, which fill in `a`.
void declare_options(cli::Options& options, Arguments& a);

}  // namespace tdpt
