// exrdiff: measures how far a picture is from its reference.

#include "libcommon/base/error.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/options/picture_options.h"
#include "tools/exrdiff/measure.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "exrdiff",
    "Tells how far a picture is from its reference: MAPE, PSNR, MSE, relMSE.",
    "Difference picture to write: false colour for .png, else OpenEXR; default "
    "none",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit,
    cli::kNone};

struct Arguments {
  std::string picture, reference, beside;
  std::optional<double> exposure;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.common.output.clear();
  options.argument("picture", a.picture, "Picture to judge (.exr); - is standard input");
  options.argument("reference", a.reference, "What it should be (.exr); - is standard input");
  options.side_output("--side-by-side", a.beside,
                      "Write a PNG with the picture left of the reference, exposed alike");
  declare_exposure(options, a.exposure, "--side-by-side");
}

// The file for -o.
std::string difference_bytes(const cli::Common& common, const PictureInput& picture,
                             const PictureInput& reference) {
  const Picture& p = picture.file.picture;
  const Picture& r = reference.file.picture;
  if (suffix_of(common.output) == ".png") return png_bytes(false_colour(p, r));
  ExrFile file;
  file.picture = difference(p, r);
  set_provenance(file, common.provenance({picture.source, reference.source}));
  return exr_bytes(file);
}

int run(const Arguments& a, const cli::Common& common) {
  if (a.exposure && a.beside.empty()) throw UsageError("--exposure goes with --side-by-side");
  const PictureInput picture = read_picture(a.picture, common);
  const PictureInput reference = read_picture(a.reference, common);
  const Picture& p = picture.file.picture;
  const Picture& r = reference.file.picture;
  if (reference.file.attributes.contains(denoiser_attribute))
    common.warn(reference.name + ": is filtered, so it is biased and no good reference");
  const Comparison comparison = compare(p, picture.name, r, reference.name);
  const std::optional<double> exposure = exposure_of(r, a.beside, a.exposure);
  cli::deliver({{common.output, [&] { return difference_bytes(common, picture, reference); }},
                {a.beside, [&] { return png_bytes(side_by_side(p, r, *exposure)); }}},
               common);
  common.print(common.json ? report_json(comparison, exposure) + "\n" : report_text(comparison));
  common.explain_by([&] { return decisions_of(comparison, r); });
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
