// tdpt: makes a scene's picture through its portals, by running the other programs.
#include <set>

#include <fmt/format.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt/cache.h"
#include "tools/tdpt/making.h"

#include <unistd.h>

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt",
    "Finds the portals of a glTF scene and renders it through them. It has "
    "the options of tdpt-render; what the stages before it need of them they get.",
    "Picture to write (.exr), or the portals alone (.glb)",
    cli::Result::text,
    cli::kLibraries,
    cli::kCommit};

// The renderer lists them: tdpt only starts other programs.
std::string list_of_devices() {
  const std::string renderer = program_folder() + "/tdpt-render";
  ::execl(renderer.c_str(), renderer.c_str(), "--list-devices", nullptr);
  throw Error(Exit::internal, renderer + ": cannot be started");
}

void declare_options(cli::Options& options, Arguments& a) {
  using cli::Effect;
  declare_render_options(options, a);
  options.part(cli::Part::files);
  options.argument("scene", a.scene, "Scene (.glb, .gltf)", false);
  options.flag("--force", a.force, "Replace a picture that another command, or nobody known, made",
               Effect::report);
  options.output_beside(
      "--report", a.report,
      [](const std::string& picture) {
        return picture.substr(0, picture.find_last_of('.')) + ".report.html";
      },
      "Write PICTURE.report.html, too: what portals are worth (needs python3)");
  options.option("--work", a.work, "FOLDER",
                 "Where the stages' files are kept; default tdpt in the user's cache folder",
                 Effect::report);
  options.option("--work-size", a.work_size, "SIZE",
                 "Largest size of that folder: what was used longest ago goes; default 10G",
                 Effect::report);
  options.flag("--clean", a.clean, "Empty that folder", Effect::report);
  options.part(cli::Part::telling);
  options.flag("--dry-run", a.dry_run, "Print the commands that would run, and run none",
               Effect::report);
  options.part(cli::Part::effort);
  options.option("--device", a.device, "cpu|gpu[:WHICH]",
                 "Where to count light and to render; default cpu. WHICH: number or part of the "
                 "name of a Vulkan device; else the best",
                 Effect::samples);
  options.part(cli::Part::telling);
  options.instead("--list-devices", list_of_devices, "List the Vulkan devices and exit");
}

int clean(const Arguments& a) {
  const Cache cache(a.work.empty() ? Cache::usual_path() : a.work);
  cache.check_has_no_others();
  cache.shrink_to(0);
  return 0;
}

int run(const Arguments& a, const cli::Common& common) {
  if (!parse_size(a.work_size))
    throw UsageError("--work-size: '" + a.work_size + "' given, expected a size, as 500M or 10G");
  if (a.clean) return clean(a);
  check_render_arguments(a);
  catch_signals();
  std::set<std::string> printed;
  const std::vector<View> views = views_of(a, common);
  if (views.size() > 1 && !a.report.empty() && !a.dry_run)
    common.note(fmt::format("{} pictures with a report each, one after the other", views.size()));
  for (const View& view : views) {
    if (a.dry_run)
      common.print(commands_of(view.arguments, view.common, printed));
    else if (const int code = make(view.arguments, view.common); code != 0)
      return code;
  }
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
