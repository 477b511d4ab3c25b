// What --help prints, in lines of 80 columns. Internal to this room: CLI11 stays behind cli.h.
#pragma once
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "libcommon/cli/cli.h"

namespace tdpt::cli {

/// Title of this section, used as CLI11's group.
std::string title_of(Part part);

/// CLI11 knows a setting as an option named "--set.walks", in a group of its own.
inline constexpr const char* kSetting = "--set.";
extern const char* const kSettings;  ///< the title of that group
extern const char* const kLimits;    ///< and of Options::limit()
/// Its name, "walks"; empty for an ordinary option.
std::string setting_name(const CLI::Option* option);

/// Options on the left, descriptions on the right, wrapped between words.
std::shared_ptr<CLI::FormatterBase> help_in_80_columns();

}  // namespace tdpt::cli
