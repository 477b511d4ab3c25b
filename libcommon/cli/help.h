// What --help prints, in lines of 80 columns. Of cli.cpp alone: CLI11 stays behind cli.h.
#pragma once
#include <memory>

#include <CLI/CLI.hpp>

namespace tdpt::cli {

/// Options on the left, what they do on the right, broken between words.
std::shared_ptr<CLI::FormatterBase> help_in_80_columns();

}  // namespace tdpt::cli
