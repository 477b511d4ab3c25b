// tdpt-render: renders a glTF scene by path tracing, through portals where given.
#include <cstdio>
#include <filesystem>
#include <optional>

#include "libcommon/base/processor.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/built_with.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/oidn.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/picture_run.h"
#include "tools/tdpt-render/run/shot.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt-render",
    "Renders a glTF scene by (tri-directional) path tracing, with portals where "
    "there are any.",
    "Picture to write (OpenEXR); default standard output",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit};

int print_shards(const Arguments& a, const cli::Common& common) {
  const std::string commands = shard_commands(a, common.arguments, common.output);
  std::fputs(commands.c_str(), stdout);
  if (!a.plan.empty() && !std::filesystem::exists(a.plan))
    common.note("there is no " + a.plan + " yet: the same command without --shard and -o makes it");
  common.note((a.shot.is_given() ? "then merge those of each frame: " : "then merge them: ") +
              merge_command(a, common.output));
  return 0;
}

int run(const Arguments& a, const cli::Common& common) {
  check_render_arguments(a);
  if (a.shot.is_given()) check_frames(a, common);
  if (!a.shard.empty()) check_stores_film(a, "--shard");
  Workshop shop{device_asked(a.device)};
  if (prints_shards(a)) return print_shards(a, common);
  choose_processor_code(a.isa, common.arguments);
  if (a.denoiser == kDenoisers.back())
    denoise::OpenImageDenoise();  // or there is no use in rendering
  check_schedule(a);
  catch_signals();
  if (a.shot.is_given()) return render_shot(a, common, shop);
  std::optional<PlanFile> plan;
  if (obeys_plan(a, common.output_given)) plan = read_plan_file(a.plan);
  return render_picture(a, common, shop, plan ? &*plan : nullptr).code;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
