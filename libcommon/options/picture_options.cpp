#include "libcommon/options/picture_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/tone.h"

namespace tdpt {

void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview) {
  options.option("--exposure", exposure, "STOPS",
                 fmt::format("Exposure of {}; default automatic, and --json tells it", preview),
                 -kMostStops, kMostStops, cli::Effect::report);
}

void declare_picture_options(cli::Options& options, PictureArguments& a) {
  options.output_beside("--preview", a.preview, cli::png_beside, "Write a PNG beside the picture");
  declare_exposure(options, a.exposure, "--preview");
}

void check_picture_arguments(const PictureArguments& a) {
  if (a.exposure && a.preview.empty()) throw UsageError("--exposure goes with --preview");
}

void warn_of_missing_data(const ExrFile& file, const std::string& name, const cli::Common& common) {
  if (file.pixels_without_data > 0)
    common.warn(fmt::format("{}: {} without data, taken as black", name,
                            counted(file.pixels_without_data, "pixel")));
}

PictureInput read_picture(const std::string& path, const cli::Common& common,
                          ExrFile (*parse)(std::string_view, const std::string&)) {
  const std::string bytes = read_file(path), name = display_name(path);
  PictureInput input{parse(bytes, name), name, {path, content_hash(bytes), {}}};
  input.source.provenance = provenance_of(input.file);
  warn_of_missing_data(input.file, name, common);
  return input;
}

Vec3d mean_of(const Picture& picture) {
  Vec3d sum;
  for (const Rgb& p : picture.pixels) sum += Vec3d(p);
  return sum / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

double nonzero_of(const Picture& picture) {
  size_t n = 0;
  for (const Rgb& p : picture.pixels) n += p != Rgb{};
  return static_cast<double>(n) / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

std::optional<double> exposure_of(const Picture& picture, const std::string& path,
                                  std::optional<double> given) {
  if (path.empty()) return {};
  return given ? *given : auto_exposure(picture);
}

}  // namespace tdpt
