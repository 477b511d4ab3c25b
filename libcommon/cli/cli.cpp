#include "libcommon/cli/cli.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"
#include "libcommon/base/progress.h"
#include "libcommon/base/say.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/completion.h"
#include "libcommon/cli/dependencies.h"
#include "libcommon/cli/help.h"
#include "libcommon/cli/nearest.h"
#include "libcommon/cli/told.h"
#include "libcommon/cli/validators.h"
#include "tdpt_version.h"

namespace tdpt::cli {

Provenance Common::provenance(const std::vector<Input>& inputs) const {
  Provenance p;
  if (no_provenance) return p;
  for (const Input& input : inputs) p.inherit(input.provenance);
  p.made_by(tool, command);
  for (const Input& input : inputs) p.from(input.path, input.hash);
  return p;
}

void Common::note(const std::string& sentence) const {
  if (!quiet) say(fmt::format("{}: {}", tool, sentence));
}

void Common::explain_by(const std::function<Decisions()>& decisions) const {
  if (!explain) return;
  for (const Decision& d : decisions()) say(fmt::format("{}: {}", tool, sentence(d)));
}

void Common::warn(const std::string& sentence) const {
  say(fmt::format("{}: warning: {}", tool, sentence));
}

void Common::note_of(const std::string& file, const std::string& sentence) const {
  if (!quiet && is_news(file, sentence)) note(sentence);
}

void Common::warn_of(const std::string& file, const std::string& sentence) const {
  if (is_news(file, sentence)) warn(sentence);
}

void Common::summary(const std::string& json_text) const {
  if (json) fmt::print(output == "-" ? stderr : stdout, "{}\n", json_text);
}

void Common::also_read(const std::vector<std::string>& paths) const {
  check_outputs(outputs, paths);
  // What is made under another name gets that of the target in the end.
  if (!target_.empty()) check_outputs({{"-MQ", target_}}, paths);
  if (!dependencies.empty()) std::for_each(paths.begin(), paths.end(), check_make_name);
  read_.insert(read_.end(), paths.begin(), paths.end());
}

std::string Common::dependency_rule() const {
  return make_rule(target_.empty() ? output : target_, read_);
}

void Common::check_dependencies() const {
  if (dependencies.empty() && !target_.empty()) throw UsageError("-MQ goes with -MF");
  if (dependencies.empty()) return;
  if (output == "-" || (output.empty() && target_.empty()))
    throw UsageError("-MF tells what a file was made from: give -o FILE");
  check_make_name(target_.empty() ? output : target_);
}

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

// As people write them, "--set walks", and as CLI11 knows them, "--set.walks".
std::string for_people(const std::string& text) {
  return replaced(text, kSetting, "--set ");
}
std::string for_cli11(const std::string& text) {
  return replaced(text, "--set ", kSetting);
}

std::string name_of(const CLI::Option* option) {
  return option->get_lnames().empty() ? option->get_name()
                                      : for_people("--" + option->get_lnames().front());
}

}  // namespace

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

  // What the words of --quality mean, to the knobs and to `common`.
  void set_quality(Common& common) const {
    if (!quality.empty())
      common.quality = quality == "draft"  ? Quality::draft
                       : quality == "high" ? Quality::high
                                           : Quality::normal;
    for (const auto& knob : knobs) knob(common.quality);
  }

  void limit(int threads) const {
    limit_threads(threads);
    if (const auto bytes = parse_size(most_memory)) limit_memory(*bytes);
  }

  template <class T>
  CLI::Option* add(const std::string& flags, T& target, const std::string& value_name,
                   const std::string& help) {
    return app.add_option(for_cli11(flags), target, help)->type_name(value_name);
  }

  void keep(CLI::Option* option, Shapes shapes, Is is = Is::setting,
            std::function<bool(const std::string&)> is_file = {}) {
    if (!setting_name(option).empty()) option->group(kSettings);
    entries.push_back({option, shapes, is, std::move(is_file)});
  }

  std::vector<std::string> settings() const {
    std::vector<std::string> names;
    for (const Entry& e : entries)
      if (const std::string name = setting_name(e.option); !name.empty()) names.push_back(name);
    return names;
  }

  // The command line with each `--set NAME=VALUE` as the option that CLI11 knows it by.
  std::vector<std::string> with_settings(const std::vector<std::string>& given) const {
    std::vector<std::string> words;
    for (auto word = given.begin(); word != given.end(); ++word) {
      if (*word == "--") return words.insert(words.end(), word, given.end()), words;
      const bool alone = *word == "--set" && word + 1 != given.end();
      if (!alone && !word->starts_with("--set=")) {
        words.push_back(*word);
        continue;
      }
      const std::string text = alone ? *++word : word->substr(6);
      const size_t end = text.find('=');
      const std::string name = text.substr(0, end);
      const std::vector<std::string> known = settings();
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        const std::string meant = nearest(name, known);
        throw UsageError(fmt::format("--set {}: no such setting, expected one of {}{}", text,
                                     fmt::join(known, ", "),
                                     meant.empty() ? "" : " (did you mean " + meant + "?)"));
      }
      if (end == std::string::npos)
        throw UsageError(fmt::format("--set {0}: expected {0}=VALUE", text));
      words.insert(words.end(), {kSetting + name, text.substr(end + 1)});
    }
    return words;
  }

  // All files that the command line names as `is`, by option.
  std::vector<NamedFile> files(Is is) const {
    std::vector<NamedFile> files;
    for (const Entry& e : entries)
      if ((e.use ? e.use() : e.is) == is)
        for (const std::string& path : e.option->results())
          if (!e.is_file || e.is_file(path)) files.push_back({name_of(e.option), path});
    return files;
  }

  void spare_terminal(const std::string& path) const {
    if (path != "-" || result == Result::text || (is_text && is_text())) return;
    if (::isatty(STDOUT_FILENO))
      throw UsageError(
          "the result is binary and standard output is a terminal: name a file with -o FILE, or "
          "send it to a file or a pipe");
  }

  // `path`: where -o goes; empty: nowhere.
  std::vector<NamedFile> outputs(const std::string& path) const {
    if (check_name) check_name(path);
    std::vector<NamedFile> outputs;
    if (!path.empty() || !files(Is::output).empty()) outputs.push_back({"-o", path});
    for (const NamedFile& file : files(Is::side_output)) outputs.push_back(file);
    for (const Beside& beside : besides) {
      if (beside.flag->count() == 0) continue;
      *beside.target = beside.path_of(path);
      outputs.push_back({name_of(beside.flag), *beside.target});
    }
    return outputs;
  }

  bool is_given(const std::string& name) const {
    const CLI::Option* option = app.get_option_no_throw(name);
    return option && option->count() > 0;
  }

  std::vector<std::string> inputs() const {
    std::vector<std::string> paths;
    for (const NamedFile& file : files(Is::input)) paths.push_back(file.path);
    if (std::count(paths.begin(), paths.end(), "-") > 1)
      throw UsageError("only one input can be the standard input");
    return paths;
  }

  // The table as a shell is told of it, --help and --version with it.
  std::vector<Completed> completed() const {
    std::vector<Completed> table;
    for (const CLI::Option* option : app.get_options()) {
      Completed& c = table.emplace_back();
      c.setting = setting_name(option);
      for (const std::string& name : option->get_lnames()) c.names.push_back("--" + name);
      for (const std::string& name : option->get_snames()) c.names.push_back("-" + name);
      if (c.names.empty()) c.names.push_back(option->get_name());
      c.help = option->get_description();
      if (option->get_items_expected_max() > 0) c.value = option->get_type_name();
      c.words = words_of(c.value);
      if (option == set)
        for (const std::string& name : settings()) c.words.push_back(name + "=");
      c.repeated = option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
      for (const Entry& e : entries)
        if (e.option == option) {
          c.file = e.is != Is::setting;
          if (e.is == Is::input) c.suffixes = suffixes_in(c.help);
        }
    }
    return table;
  }

  // What is wrong with the command line. An option that there is not is told before what lacks.
  std::string fault(const CLI::ParseError& error) const {
    const int code = error.get_exit_code();
    if (code == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
        code == static_cast<int>(CLI::ExitCodes::RequiredError))
      for (const std::string& given : app.remaining())
        if (given.size() > 1 && given[0] == '-') return no_such_option(given);
    return for_people(error.what());
  }

  // `given`: "--name", "-name" or "--name=value".
  std::string no_such_option(const std::string& given) const {
    const std::string option = given.substr(0, given.find('='));
    std::vector<std::string> names, known = settings();
    for (const CLI::Option* each : app.get_options())
      for (const std::string& name : each->get_lnames()) names.push_back(name);
    names.insert(names.end(), known.begin(), known.end());
    const size_t start = std::min(option.find_first_not_of('-'), option.size());
    const std::string meant = nearest(option.substr(start), names);
    const char* dashes = app.get_option_no_throw("--" + meant) ? "--" : "--set ";
    return fmt::format("{}: no such option{}", for_people(option),
                       meant.empty() ? "" : fmt::format(" (did you mean {}{}?)", dashes, meant));
  }

  std::vector<Given> given() const {
    std::vector<Given> all;
    for (const Entry& e : entries) {
      if (e.option->count() == 0 || e.option->get_lnames().empty()) continue;
      Given& one = all.emplace_back(Given{name_of(e.option), {}});
      if (e.option->get_items_expected_max() > 0) one.values = e.option->results();
    }
    return all;
  }

  // The tool and the options that shape the result, in the order of the table; paths of inputs are
  // named by their `from` lines and do not stand here.
  std::string canonical(const std::string& tool) const {
    std::string text = tool;
    for (const Entry& e : entries) {
      if (e.shapes == Shapes::nothing || e.option->count() == 0) continue;
      const std::string name = name_of(e.option);
      const char* before_value = name.starts_with("--set ") ? "=" : " ";
      if (e.option->get_items_expected_max() == 0) {
        text += " " + name;
        continue;
      }
      for (const std::string& value : e.option->results())
        if (!e.is_file || !e.is_file(value))
          text += " " + name + before_value + value.substr(value.find_last_of('/') + 1);
    }
    return text;
  }
};

namespace {
// Thrown out of the parser, which has not looked at what is required by then.
struct Instead {
  std::function<std::string()> text;
};
}  // namespace

Options::Options(const Program& program)
    : impl_(std::make_unique<Impl>(program.summary, program.tool)) {
  common.tool = program.tool;
  impl_->result = program.result;
  CLI::App& app = impl_->app;
  app.formatter(help_in_80_columns());
  const auto uses = [&](Uses what) { return (program.uses & what) != 0; };
  part(Part::general);
  if (uses(kSeed))
    impl_->keep(impl_->add("--seed", common.seed, "N", "Seed of the random numbers; default 1")
                    ->check(whole_number()),
                Shapes::result);
  if (uses(kThreads))
    option("--threads", common.threads, "N", "Threads to use; default all cores", 0, 4096,
           Shapes::nothing);
  impl_->keep(impl_
                  ->add("--max-memory,--set max-memory", impl_->most_memory, "SIZE",
                        "Most memory that reading a file may take; default three quarters of "
                        "the machine's")
                  ->check(size()),
              Shapes::nothing);
  if (program.output_help) {
    flag("--no-provenance", common.no_provenance, "Leave out where the file comes from",
         Shapes::nothing);
    side_output("--set dependencies", common.dependencies,
                "Write a rule for Make: what the result was made from; also -MF FILE");
    option("--set dependencies-target", common.target_, "NAME",
           "What that rule is for; default what -o names; also -MQ NAME", Shapes::nothing);
  }
  static std::vector<std::string> none;
  impl_->set = impl_->add("--set", none, "NAME=VALUE", "One of the settings below")->take_all();
  const auto complete = [this](const std::string& shell) {
    throw Instead{[=, this] { return completion_script(shell, common.tool, impl_->completed()); }};
  };
  impl_->keep(app.add_option_function<std::string>(
                     "--completion", complete,
                     "Print a script that completes these options in a shell and exit")
                  ->type_name("bash|zsh|fish")
                  ->check(one_of({"bash", "zsh", "fish"})),
              Shapes::nothing);
  app.set_help_flag("-h,--help", "Print this help and exit");
  const std::string commit =
      *program.commit ? fmt::format(" (commit {})", program.commit) : std::string();
  app.set_version_flag(
      "--version",
      fmt::format("{} {}{}\n{}", program.tool, TDPT_VERSION, commit, program.libraries),
      "Print the versions of the program and its libraries and exit");
  part(Part::telling);
  if (uses(kQuiet))
    flag("--quiet", common.quiet, "No progress and no notes on stderr", Shapes::nothing);
  if (uses(kProgress))
    choice("--set progress", impl_->progress, {"auto", "json", "none"},
           "Progress on stderr: auto, a line on a terminal (the default); json, an object a line",
           Shapes::nothing);
  flag("--explain", common.explain, "Print on stderr what was decided, why, and what it costs",
       Shapes::nothing);
  flag("--json", common.json,
       "Print a summary as JSON on stdout (on stderr when the result goes to stdout)",
       Shapes::nothing);
  part(Part::files);
  if (program.output_help)
    impl_->keep(impl_->add("-o,--output", common.output, "FILE", program.output_help),
                Shapes::nothing, Impl::Is::output);
}

Options::~Options() = default;

void Options::part(Part part) {
  impl_->app.option_defaults()->group(title_of(part));
}

void Options::argument(const std::string& name, std::string& target, const std::string& help,
                       bool required) {
  impl_->keep(impl_->add(name, target, "FILE", help)->required(required), Shapes::nothing,
              Impl::Is::input);
}

void Options::arguments(const std::string& name, std::vector<std::string>& target,
                        const std::string& help) {
  impl_->keep(impl_->add(name, target, "FILE", help)->required(), Shapes::nothing, Impl::Is::input);
}

void Options::input(const std::string& flags, std::string& target, const std::string& value_name,
                    const std::string& help) {
  impl_->keep(impl_->add(flags, target, value_name, help), Shapes::nothing, Impl::Is::input);
}

void Options::inputs(const std::string& flags, std::vector<std::string>& target,
                     const std::string& value_name, const std::string& help) {
  impl_->keep(impl_->add(flags, target, value_name, help)->expected(1)->take_all(), Shapes::nothing,
              Impl::Is::input);
}

void Options::input_or_setting(const std::string& flags, std::string& target,
                               const std::string& value_name, const std::string& help,
                               const std::function<bool(const std::string&)>& is_file) {
  impl_->keep(impl_->add(flags, target, value_name, help), Shapes::result, Impl::Is::input,
              is_file);
}

void Options::option(const std::string& flags, std::string& target, const std::string& value_name,
                     const std::string& help, Shapes shapes) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(some_text()), shapes);
}

void Options::option(const std::string& flags, int64_t& target, const std::string& value_name,
                     const std::string& help, int64_t lowest, int64_t highest, Shapes shapes) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), shapes);
}

void Options::option(const std::string& flags, double& target, const std::string& value_name,
                     const std::string& help, double lowest, double highest, Shapes shapes) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), shapes);
}

void Options::option(const std::string& flags, std::optional<double>& target,
                     const std::string& value_name, const std::string& help, double lowest,
                     double highest, Shapes shapes) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), shapes);
}

void Options::quality() {
  choice("--quality", impl_->quality, {"draft", "normal", "high"},
         "Speed or accuracy; default normal");
}

void Options::option(const std::string& flags, int64_t& target, const ByQuality<int64_t>& defaults,
                     const std::string& value_name, const std::string& help, int64_t lowest,
                     int64_t highest) {
  target = defaults.normal;
  option(flags, target, value_name,
         fmt::format("{}; default {} (draft {}, high {})", help, defaults.normal, defaults.draft,
                     defaults.high),
         lowest, highest);
  const CLI::Option* const given = impl_->entries.back().option;
  impl_->knobs.emplace_back([given, &target, defaults](Quality quality) {
    if (given->count() == 0) target = defaults.at(quality);
  });
}

void Options::choice(const std::string& flags, std::string& target,
                     const std::vector<std::string>& words, const std::string& help,
                     Shapes shapes) {
  impl_->keep(impl_->add(flags, target, fmt::format("{}", fmt::join(words, "|")), help)
                  ->check(one_of(words)),
              shapes);
}

void Options::side_output(const std::string& flags, std::string& target, const std::string& help) {
  impl_->keep(impl_->add(flags, target, "FILE", help), Shapes::nothing, Impl::Is::side_output);
}

void Options::file(const std::string& flags, std::string& target, const std::string& help,
                   const std::function<Use()>& use) {
  impl_->keep(impl_->add(flags, target, "FILE", help), Shapes::nothing);
  impl_->entries.back().use = [use] {
    const Use now = use();
    return now == Use::read      ? Impl::Is::input
           : now == Use::written ? Impl::Is::side_output
                                 : Impl::Is::setting;
  };
}

void Options::output_beside(const std::string& flags, std::string& target,
                            const std::function<std::string(const std::string&)>& path_of,
                            const std::string& help) {
  CLI::Option* const flag = impl_->app.add_flag(flags, help);
  impl_->keep(flag, Shapes::nothing);
  impl_->besides.push_back({flag, &target, path_of});
}

void Options::result_name(const std::function<void(const std::string&)>& check) {
  impl_->check_name = check;
}

void Options::result_is_text(const std::function<bool()>& is_text) {
  impl_->is_text = is_text;
}

void Options::flag(const std::string& flags, bool& target, const std::string& help, Shapes shapes) {
  impl_->keep(impl_->app.add_flag(flags, target, help), shapes);
}

void Options::instead(const std::string& flags, const std::function<std::string()>& text,
                      const std::string& help) {
  impl_->keep(impl_->app.add_flag_callback(
                  flags, [text] { throw Instead{text}; }, help),
              Shapes::nothing);
}

int Options::run_main(int argc, char** argv, const std::function<int()>& run) {
  const auto fail = [this](Exit code, const std::string& text) {
    std::string line = text;
    for (char& c : line)
      if (c == '\n' || c == '\r') c = ' ';
    std::cout.flush();
    say(fmt::format("{}: {}", common.tool, line));
    return static_cast<int>(code);
  };
  // What was printed may still be in a buffer, or have failed when it was full: a full disk shows
  // here.
  const auto flushed = [&](int code) {
    if ((std::fflush(stdout) == 0 && !std::ferror(stdout)) || code != 0) return code;
    return fail(Exit::output, "(standard output): cannot be written");
  };
  const auto print = [&](const std::string& text) {
    std::fputs(text.c_str(), stdout);
    return flushed(0);
  };
  open_standard_streams();
  try {
    try {
      std::vector<std::string> words = impl_->with_settings(without_short_forms(argc, argv));
      std::reverse(words.begin(), words.end());
      impl_->app.parse(words);
    } catch (const Instead& instead) {
      return print(instead.text());
    } catch (const CLI::CallForHelp&) {
      return print(impl_->app.help());
    } catch (const CLI::CallForVersion&) {
      return print(impl_->app.version());
    } catch (const CLI::ParseError& e) {
      throw UsageError(
          fmt::format("{}; '{} --help' lists the options", impl_->fault(e), common.tool));
    }
    common.arguments.assign(argv, argv + argc);
    common.output_given = impl_->is_given("-o");
    common.given = impl_->given();
    impl_->spare_terminal(common.output);
    impl_->set_quality(common);
    common.command = impl_->canonical(common.tool);
    common.outputs = impl_->outputs(common.output);
    common.check_dependencies();
    common.also_read(impl_->inputs());
    check_outputs(common.outputs);
    impl_->limit(common.threads);
    show_progress_as(impl_->progress == "json"   ? ProgressForm::json
                     : impl_->progress == "none" ? ProgressForm::none
                                                 : ProgressForm::automatic);
    return flushed(run());
  } catch (const Error& e) {
    return fail(e.code, e.what());
  } catch (const std::bad_alloc&) {
    return fail(Exit::internal, "out of memory");
  } catch (const std::exception& e) {
    return fail(Exit::internal, fmt::format("internal error: {}", e.what()));
  }
}

}  // namespace tdpt::cli
