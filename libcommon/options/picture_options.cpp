#include "libcommon/options/picture_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/tone.h"

namespace tdpt {

Storage PictureArguments::storage() const {
  return {pixels == "half" ? Storage::half : Storage::real, compression == "dwaa"   ? Storage::dwaa
                                                            : compression == "dwab" ? Storage::dwab
                                                                                    : Storage::zip};
}

void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview) {
  options.option("--exposure", exposure, "STOPS",
                 fmt::format("Exposure of {}; default automatic, and --explain tells it", preview),
                 -kMostStops, kMostStops, cli::Effect::report);
}

void declare_picture_options(cli::Options& options, PictureArguments& a) {
  options.output_beside("--preview", a.preview, cli::png_beside, "Write a PNG beside the picture");
  declare_exposure(options, a.exposure, "--preview");
  options.choice("--set pixels", a.pixels, {"float", "half"},
                 "Numbers of the picture's colours; default float", cli::Effect::stored);
  options.choice("--set compression", a.compression, {"zip", "dwaa", "dwab"},
                 "Compression of the picture; dwaa and dwab are lossy, for colours; default zip",
                 cli::Effect::stored);
}

void check_picture_arguments(const PictureArguments& a) {
  if (a.exposure && a.preview.empty()) throw UsageError("--exposure goes with --preview");
}

void check_stores_film(const PictureArguments& a, const std::string& option) {
  if (a.storage().rounds())
    throw UsageError(option +
                     " writes a film, which keeps every digit: --set pixels and --set compression "
                     "are for pictures");
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
       given ? "--exposure says so" : "most of the picture is then middle grey",
       given ? "" : fmt::format("--exposure {} shows other pictures alike", *used)});
  return decisions;
}

void warn_of_range(const ExrFile& file, const Storage& storage, const cli::Common& common) {
  if (!storage.rounds()) return;
  constexpr float smallest = 0x1p-24f;
  constexpr double few = 0.01;  // share of the pixels
  int64_t large = 0, small = 0, lit = 0;
  const auto largest = [](const Rgb& c) {
    return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
  };
  for (size_t i = 0; i < file.picture.pixels.size(); ++i) {
    const float p = largest(file.picture.pixels[i]);
    large += p > storage.largest() ||
             std::any_of(file.layers.begin(), file.layers.end(), [&](const auto& layer) {
               return largest(layer.second.pixels[i]) > storage.largest();
             });
    small += p > 0 && p < smallest;
    lit += p > 0;
  }
  const bool vanish = static_cast<double>(small) > few * static_cast<double>(lit);
  if (large == 0 && !vanish) return;
  std::string text = "stored as half floats, ";
  if (large > 0)
    text += fmt::format("{} brighter than {} {} cut to it", counted(large, "pixel"),
                        storage.largest(), large == 1 ? "is" : "are");
  if (large > 0 && vanish) text += ", and ";
  if (vanish) text += counted(small, "pixel") + " darker than 6e-8 may be black";
  common.warn(text);
}

}  // namespace tdpt
