// The options of all programs that write a picture, for the PNG that shows it.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/picture.h"

namespace tdpt {

struct PictureArguments {
  std::string preview;             ///< path of the PNG; empty: not asked for
  std::optional<double> exposure;  ///< --exposure [stops]
};

/// --preview, --exposure. Neither changes the provenance.
void declare_picture_options(cli::Options& options, PictureArguments& a);
/// --exposure alone; `preview`: the option that it goes with.
void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview);

/// Throws UsageError for --exposure without --preview.
void check_picture_arguments(const PictureArguments& a);

/// A picture that a program reads, and its part in the provenance of the result.
struct PictureInput {
  ExrFile file;
  std::string name;
  cli::Common::Input source;
};
/// `parse`: parse_exr(), or a stricter reader. Warns of pixels without data. Throws InputError.
PictureInput read_picture(const std::string& path, const cli::Common& common,
                          ExrFile (*parse)(std::string_view, const std::string&) = parse_exr);
void warn_of_missing_data(const ExrFile& file, const std::string& name, const cli::Common& common);

Vec3d mean_of(const Picture& picture);      ///< over all pixels
double nonzero_of(const Picture& picture);  ///< share of pixels that are not black

/// Exposure [stops] of a picture in the PNG `path`: as given, else automatic; nothing if there is
/// no such file.
std::optional<double> exposure_of(const Picture& picture, const std::string& path,
                                  std::optional<double> given);
}  // namespace tdpt
