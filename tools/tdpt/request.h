// What a command line of tdpt asks for, as the words of the programs that do it.
#pragma once
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/render_options.h"

namespace tdpt {

struct Arguments : RenderArguments {
  std::string work;               ///< --work; empty: the usual folder
  std::string work_size = "10G";  ///< --work-size
  std::string report;             ///< its path; empty: not asked for
  bool force = false, dry_run = false, clean = false;
};

using Words = std::vector<std::string>;

/// Words of options, by who is given them.
struct Request {
  std::string scene;    ///< path, as programs are given it
  std::string picture;  ///< path
  Words camera, sky, device, all;
  Words sampling;  ///< of those that draw random numbers: --seed and --quality
  Words render;    ///< of the renderer alone, that shape the picture
  Words unshaped;  ///< of all programs, that shape nothing: --threads and the like
  Words beside;    ///< of the renderer alone, that shape nothing
  /// More options for each stage, by the environment: FFGRAPH_FLAGS, MINCUT_FLAGS, LIGHTGRID_FLAGS,
  /// PORTALFIT_FLAGS.
  Words stage_flags[4];
  /// Who asks: the path of the scene and all words that shape the picture, files by their paths.
  Words identity;
};

/// Throws UsageError where the command line lacks what no program can tell.
Request request_of(const Arguments& a, const cli::Common& common);

/// Whether the picture can make use of portals that the stages find.
bool uses_portals(const Arguments& a, bool scene_has_sky);

/// What the request of `then` had and that of `now` has not, for people: "with --width 16, not
/// --width 24".
std::string difference(const Words& then, const Words& now);

}  // namespace tdpt
