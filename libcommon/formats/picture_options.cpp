#include "libcommon/formats/picture_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/tone.h"

namespace tdpt {

void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview) {
  options.option("--exposure", exposure, "STOPS",
                 fmt::format("Exposure of {}; default automatic, and --explain tells it", preview),
                 -kMostStops, kMostStops, cli::Shapes::nothing);
}

void declare_picture_options(cli::Options& options, PictureArguments& a) {
  options.output_beside("--preview", a.preview, cli::png_beside, "Write a PNG beside the picture");
  declare_exposure(options, a.exposure, "--preview");
}

void check_picture_arguments(const PictureArguments& a) {
  if (a.exposure && a.preview.empty()) throw UsageError("--exposure goes with --preview");
}

std::optional<double> exposure_of(const Picture& picture, const std::string& path,
                                  std::optional<double> given) {
  if (path.empty()) return {};
  return given ? *given : auto_exposure(picture);
}

cli::Decisions with_exposure(cli::Decisions decisions, std::optional<double> given,
                             std::optional<double> used) {
  if (!used) return decisions;
  decisions.push_back(
      {"exposure", fmt::format("{} stops", *used),
       given ? "--exposure says so" : "what is shown is then middle grey in the mean",
       given ? "" : fmt::format("--exposure {} shows other pictures alike", *used)});
  return decisions;
}

}  // namespace tdpt
