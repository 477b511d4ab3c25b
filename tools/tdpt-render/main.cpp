// tdpt-render: renders a glTF scene by path tracing, through portals where given.
#include "libcommon/base/process.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/oidn.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/run/options.h"
#include "tools/tdpt-render/run/picture.h"
#include "tools/tdpt-render/run/progress.h"

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

int run(const RenderArguments& a, const cli::Common& common) {
  check_options(a);
  if (a.shot.is_given())
    check_frames(a, common);
  else
    check_checkpoint(a);
  choose_processor_code(a.isa, common.arguments);
  if (a.denoiser == kDenoisers.back())
    denoise::OpenImageDenoise();  // or there is no use in rendering
  SceneCache scenes(device_asked(a.device));
  catch_signals();
  if (a.shot.is_given()) return render_shot(a, common, scenes);
  return render_picture(a, common, scenes).code;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
