// What --help prints, in lines of 80 columns. Internal to this room: CLI11 stays behind cli.h.
#pragma once
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "libcommon/cli/cli.h"

namespace tdpt::cli {

/// CLI11's group of the options that --help lists in this part.
std::string title_of(Part part);

/// A setting is an option of CLI11 of the name "--set.walks", in a group of its own.
inline constexpr const char* kSetting = "--set.";
extern const char* const kSettings;  ///< the title of that group
/// Its name, "walks"; empty where the option is none.
std::string setting_name(const CLI::Option* option);

/// Options on the left, what they do on the right, broken between words.
std::shared_ptr<CLI::FormatterBase> help_in_80_columns();

}  // namespace tdpt::cli
