// The options of all programs that write a picture: the PNG that shows it.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/picture.h"

namespace tdpt {

struct PictureArguments {
  std::string preview;             ///< path of the PNG; empty: not asked for
  std::optional<double> exposure;  ///< --exposure [stops]
};

/// --preview and --exposure.
void declare_picture_options(cli::Options& options, PictureArguments& a);
/// --exposure alone; `preview`: the option that it goes with.
void declare_exposure(cli::Options& options, std::optional<double>& exposure, const char* preview);

/// Throws UsageError for --exposure without --preview.
void check_picture_arguments(const PictureArguments& a);
/// Exposure [stops] of a picture in the PNG `path`: as given, else automatic; nothing if there is
/// no such file.
std::optional<double> exposure_of(const Picture& picture, const std::string& path,
                                  std::optional<double> given);
/// Adds the exposure for --explain. `given`: value of --exposure; `used`: exposure_of().
cli::Decisions with_exposure(cli::Decisions decisions, std::optional<double> given,
                             std::optional<double> used);

}  // namespace tdpt
