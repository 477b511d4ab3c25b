// The options of all programs that write a picture: how it is stored, and the PNG that shows it.
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
  std::string pixels = "float", compression = "zip";

  Storage storage() const;
};

/// --preview, --exposure, --set pixels and --set compression. None changes the provenance: a file
/// says how it is stored, and a merged one has the bytes of the undivided one.
void declare_picture_options(cli::Options& options, PictureArguments& a);
/// --exposure alone; `preview`: the option that it goes with.
void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview);

/// Throws UsageError for --exposure without --preview.
void check_picture_arguments(const PictureArguments& a);
/// Throws UsageError if a film is asked for, by `option`, and not stored exactly.
void check_stores_film(const PictureArguments& a, const std::string& option);

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

/// Exposure [stops] of a picture in the PNG `path`: as given, else automatic; nothing if there is
/// no such file.
std::optional<double> exposure_of(const Picture& picture, const std::string& path,
                                  std::optional<double> given);
/// Adds the exposure for --explain. `given`: value of --exposure; `used`: exposure_of().
cli::Decisions with_exposure(cli::Decisions decisions, std::optional<double> given,
                             std::optional<double> used);

/// Warns if its storage cannot hold the brightest pixels, layers included, or many of the darkest.
void warn_of_range(const ExrFile& file, const Storage& storage, const cli::Common& common);

}  // namespace tdpt
