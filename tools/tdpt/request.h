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
  /// Of a run for several cameras [View]: the names of all, for which portals are found
  /// together.
  std::vector<std::string> views;
};

using Words = std::vector<std::string>;
inline void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

/// Options, grouped by the programs that get them.
struct Request {
  std::string scene;    ///< path, as passed to programs
  std::string picture;  ///< path; of portals, where these are all that is asked for
  Words render;         ///< of the renderer: all options but those of tdpt itself
  // Of these, what other programs get, too.
  Words camera, pose, sky, device;
  Words cameras;   ///< those for which portals are found: `camera`, or all of several
  Words sampling;  ///< for programs that draw random numbers: --seed and --quality
  Words stored;    ///< for all programs: --no-provenance
  Words running;   ///< for all programs, not affecting results: --threads and the like
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

// One command line for the pictures of several cameras: a run for each, whose stages are the same.

/// What one picture is made by, as if its camera and its files were those on the command line.
struct View {
  Arguments arguments;
  cli::Common common;
};

/// One per camera that --camera names, else one. In the names of files % is the camera's name. The
/// scene is read only if --camera may select several. Throws UsageError for names of files without
/// %, or that two cameras share.
std::vector<View> views_of(const Arguments& a, const cli::Common& common);

}  // namespace tdpt
