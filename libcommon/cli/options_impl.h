// The table of options behind Options, and what a command line says by it. Internal to this room.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "libcommon/cli/cli.h"
#include "libcommon/cli/completion.h"

namespace tdpt::cli {

/// As CLI11 knows what people write as "--set walks".
std::string for_cli11(const std::string& text);

struct Options::Impl {
  explicit Impl(const std::string& summary, const std::string& tool) : app(summary, tool) {}

  /// What the value of an option is to the run.
  enum class Is { setting, input, output, side_output };
  struct Entry {
    CLI::Option* option;
    Shapes shapes;
    Is is = Is::setting;
    std::function<bool(const std::string&)> is_file{};  ///< of an input's value; none: always
    std::function<Is()> use{};                          ///< what it is, where that depends
  };
  CLI::App app;
  const CLI::Option* set = nullptr;  ///< --set, for --help and shells: what it says is a setting
  std::vector<Entry> entries;

  /// An output whose name follows from that of the result, by `path_of`, when the flag is given.
  struct Beside {
    CLI::Option* flag;
    std::string* target;
    std::function<std::string(const std::string&)> path_of;
  };
  std::vector<Beside> besides;
  std::function<void(const std::string&)> check_name;  ///< of the result, or none
  Result result = Result::text;
  std::function<bool()> is_text;  ///< of a binary result: whether it is not; none: never

  std::string progress = "auto";                    ///< what shows it
  std::string most_memory;                          ///< as given; empty: not
  std::string quality;                              ///< as given; empty: not
  std::vector<std::function<void(Quality)>> knobs;  ///< set what was not given

  template <class T>
  CLI::Option* add(const std::string& flags, T& target, const std::string& value_name,
                   const std::string& help) {
    return app.add_option(for_cli11(flags), target, help)->type_name(value_name);
  }
  void keep(CLI::Option* option, Shapes shapes, Is is = Is::setting,
            std::function<bool(const std::string&)> is_file = {});

  /// The command line with each `--set NAME=VALUE` as the option that CLI11 knows it by.
  std::vector<std::string> with_settings(const std::vector<std::string>& given) const;
  /// What is wrong with the command line. An option that there is not is told before what lacks.
  std::string fault(const CLI::ParseError& error) const;

  // When it is parsed.
  bool is_given(const std::string& name) const;
  std::vector<Given> given() const;
  /// The tool and the options that shape the result, in the order of the table; paths of inputs are
  /// named by their `from` lines and do not stand here.
  std::string canonical(const std::string& tool) const;
  /// What the words of --quality mean, to the knobs and to `common`.
  void set_quality(Common& common) const;
  void limit(int threads) const;
  void spare_terminal(const std::string& path) const;
  std::vector<std::string> inputs() const;
  /// `path`: where -o goes; empty: nowhere.
  std::vector<NamedFile> outputs(const std::string& path) const;

  /// The table as a shell is told of it, --help and --version with it.
  std::vector<Completed> completed() const;

 private:
  std::vector<std::string> settings() const;
  /// `given`: "--name", "-name" or "--name=value".
  std::string no_such_option(const std::string& given) const;
  /// All files that the command line names as `is`, by option.
  std::vector<NamedFile> files(Is is) const;
};

}  // namespace tdpt::cli
