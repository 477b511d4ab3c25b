// The implementation of Options: the table, and what a command line says about it. Internal to this
// room.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "libcommon/cli/cli.h"

namespace tdpt::cli {

/// "--set walks" as CLI11 knows it.
std::string for_cli11(const std::string& text);

struct Options::Impl {
  explicit Impl(const std::string& summary, const std::string& tool) : app(summary, tool) {}

  /// Role of an option's value in the run.
  enum class Is { setting, input, output, side_output };
  struct Entry {
    CLI::Option* option;
    Effect effect;
    Part part;
    Is is = Is::setting;
    std::function<bool(const std::string&)> is_file{};  ///< is the value a file? none: yes
    std::function<Is()> use{};  ///< its role, if that depends on other options
  };
  CLI::App app;
  Part part = Part::files;  ///< of the options declared now
  std::vector<Entry> entries;

  /// An output, requested by a flag, whose path `path_of` derives from that of the result.
  struct Beside {
    CLI::Option* flag;
    std::string* target;
    std::function<std::string(const std::string&)> path_of;
  };
  std::vector<Beside> besides;
  std::function<void(const std::string&)> check_name;  ///< of the result; may be empty
  Result result = Result::text;
  std::function<bool()> is_text;  ///< is a binary result text this time? none: no

  std::string progress = "auto";                    ///< how it is shown
  std::string most_memory;                          ///< as given; empty: not given
  std::string quality;                              ///< as given; empty: not given
  std::vector<std::function<void(Quality)>> knobs;  ///< set the knobs that were not given

  template <class T>
  CLI::Option* add(const std::string& flags, T& target, const std::string& value_name,
                   const std::string& help) {
    return app.add_option(for_cli11(flags), target, help)->type_name(value_name);
  }
  void keep(CLI::Option* option, Effect effect, Is is = Is::setting,
            std::function<bool(const std::string&)> is_file = {});

  /// The command line with each `--set NAME=VALUE` replaced by the option that CLI11 knows.
  std::vector<std::string> with_settings(const std::vector<std::string>& given) const;
  /// What is wrong with the command line. An unknown option is reported before a missing one.
  std::string fault(const CLI::ParseError& error) const;

  // After parsing.
  bool is_given(const std::string& name) const;
  std::vector<Given> given() const;
  /// Applies the word of --quality to the knobs and to `common`.
  void set_quality(Common& common) const;
  void limit(int threads) const;
  void spare_terminal(const std::string& path) const;
  std::vector<std::string> inputs() const;
  /// `path`: value of -o; empty: no output.
  std::vector<NamedFile> outputs(const std::string& path) const;

 private:
  std::vector<std::string> settings() const;
  /// `given`: "--name", "-name" or "--name=value".
  std::string no_such_option(const std::string& given) const;
  /// All files that the command line names in role `is`, by option.
  std::vector<NamedFile> files(Is is) const;
};

// CLI11 validators for the values of options.

/// The error says what is expected.
CLI::Validator expecting(const std::string& expected,
                         const std::function<bool(const std::string&)>& is_valid);

/// From 0 to 2^64 - 1. CLI11 alone reads -1 and too large numbers as 2^64 - 1.
CLI::Validator whole_number();

/// Bytes, as parse_size() reads them.
CLI::Validator size();

/// Not empty: an unset shell variable must not count as an option that was not given.
CLI::Validator some_text();

/// One of `words`; the error suggests the nearest.
CLI::Validator one_of(const std::vector<std::string>& words);

/// std::to_string and CLI11's own text would print 1e18 in full; people read these bounds.
template <class T>
CLI::Validator within(T lowest, T highest) {
  return expecting(fmt::format("a number from {} to {}", lowest, highest),
                   [lowest, highest](const std::string& text) {
                     T value{};
                     return CLI::detail::lexical_cast(text, value) && value >= lowest &&
                            value <= highest;
                   });
}

// What --help prints, in lines of 80 columns.

/// Title of this section, used as CLI11's group.
std::string title_of(Part part);

/// Title of the options of Options::limit().
inline constexpr const char* kLimits =
    "Limits that verdicts hang on, each given as --set NAME=VALUE; the manual explains them";

/// Options on the left, descriptions on the right, wrapped between words.
std::shared_ptr<CLI::FormatterBase> help_in_80_columns();

/// A script for bash that completes the options of this program from its --help.
std::string completion_script(const std::string& tool);

/// "walks" of the setting "--set walks"; empty for an ordinary option.
std::string setting_name(const CLI::Option* option);

/// Title of the settings in --help.
inline constexpr const char* kSettings = "Settings that few need, each given as --set NAME=VALUE";

}  // namespace tdpt::cli
