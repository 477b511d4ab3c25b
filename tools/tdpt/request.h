// A command line of tdpt, translated to the options of the programs that do the work.
#pragma once
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/options/render_options.h"

namespace tdpt {

struct Arguments : RenderArguments {
  std::string work;               ///< --work; empty: the default folder
  std::string work_size = "10G";  ///< --work-size
  std::string report;             ///< its path; empty: none
  bool force = false, dry_run = false, clean = false;
  /// Of a run for several cameras [views.h]: the names of all, for which portals are found
  /// together.
  std::vector<std::string> views;
};

using Words = std::vector<std::string>;

/// Options, grouped by the programs that get them.
struct Request {
  std::string scene;    ///< path, as passed to programs
  std::string picture;  ///< path; of portals, where these are all that is asked for
  Words camera, pose, sky, device, all;
  bool is_shot = false;  ///< `picture` is a pattern: its frames
  std::string stats;     ///< of a shot: the pattern of its statistics; empty: none are asked for
  Words shot;            ///< for the renderer
  Words cameras;         ///< those for which portals are found: `camera`, or all of several
  Words sampling;        ///< for programs that draw random numbers: --seed and --quality
  Words render;          ///< for the renderer alone: what a sample is
  Words amount;          ///< for the renderer alone: how many samples, and how they are stored
  Words unshaped;        ///< for all programs, not affecting results: --threads and the like
  Words beside;          ///< for the renderer alone, not affecting the picture
  /// For exrdenoise, which filters frames of a shot with those beside them; see filters_frames().
  Words filter;
  /// More options for each stage, from the environment: FFGRAPH_FLAGS, MINCUT_FLAGS,
  /// LIGHTGRID_FLAGS, PORTALFIT_FLAGS.
  Words stage_flags[4];
};

/// Whether -o names a file for the portals, in place of a picture.
bool asks_for_portals(const std::string& output);

/// Throws UsageError if the command line lacks what no program can find out.
Request request_of(const Arguments& a, const cli::Common& common);

/// Whether frames of a shot are filtered together. The renderer then keeps what that takes.
bool filters_frames(const RenderArguments& a);

/// Whether the picture can use portals that the stages find.
bool uses_portals(const Arguments& a, bool scene_has_sky);

}  // namespace tdpt
