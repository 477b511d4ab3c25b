// exrdiff: how far a picture is from its reference.
#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/output_file.h"
#include "libcommon/cli/cli.h"
#include "tools/exrdiff/difference.h"
#include "tools/exrdiff/measure.h"
#include "tools/exrdiff/report.h"

namespace tdpt {
namespace {

struct Arguments {
  std::string picture, reference, beside;
};

struct Input {
  ExrFile file;
  std::string name, hash;
};

Input read(const std::string& path, const cli::Common& common) {
  const std::string bytes = read_file(path);
  Input input{parse_exr(bytes, display_name(path)), display_name(path), content_hash(bytes)};
  if (input.file.pixels_without_data > 0)
    common.warn(fmt::format("{}: {} pixels have no data and count as black", input.name,
                            input.file.pixels_without_data));
  return input;
}

int run(const Arguments& a, const cli::Common& common) {
  if (a.picture == "-" && a.reference == "-")
    throw UsageError("only one of picture and reference can be standard input");
  const Input picture = read(a.picture, common), reference = read(a.reference, common);
  const Picture& p = picture.file.picture;
  const Picture& r = reference.file.picture;
  const Comparison comparison = compare(p, picture.name, r, reference.name);

  if (common.output.ends_with(".png")) {
    write_output(common.output, png_bytes(false_colour(p, r), 0));
  } else if (!common.output.empty()) {
    ExrFile file;
    file.picture = difference(p, r);
    set_provenance(
        file, common.provenance({{a.picture, picture.hash, provenance_of(picture.file)},
                                 {a.reference, reference.hash, provenance_of(reference.file)}}));
    write_output(common.output, exr_bytes(file));
  }
  if (!a.beside.empty()) write_output(a.beside, png_bytes(side_by_side(p, r), 0));

  const bool stdout_taken = common.output == "-" || a.beside == "-";
  const std::string text = common.json ? report_json(comparison) + "\n" : report_text(comparison);
  std::fputs(text.c_str(), stdout_taken ? stderr : stdout);
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Arguments a;
  cli::Options options("exrdiff",
                       "Tells how far a picture is from its reference: MAPE, PSNR, MSE, relMSE.",
                       "Difference picture to write: false colour for .png, else OpenEXR; default "
                       "none");
  options.common.output.clear();
  options.argument("picture", a.picture, "Picture to judge (OpenEXR); - is standard input");
  options.argument("reference", a.reference, "What it should be (OpenEXR); - is standard input");
  options.option("--side-by-side", a.beside, "FILE",
                 "Write a PNG with the picture left of the reference, exposed alike",
                 cli::Shapes::nothing);
  return options.run_main(argc, argv, [&] { return run(a, options.common); });
}
