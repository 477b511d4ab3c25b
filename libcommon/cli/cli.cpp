#include "libcommon/cli/cli.h"

#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>

#include <fmt/format.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/progress.h"
#include "libcommon/cli/options_impl.h"
#include "tdpt_version.h"

namespace tdpt::cli {

namespace {
// Thrown out of the parser before it checks for required arguments.
struct Instead {
  std::function<std::string()> text;
};

// A library that lacks memory or threads may end the process where nothing can catch that, even
// before main(), and nothing can be allocated any more.
void end_with_last_words() {
  for (const char* part : {static_cast<const char*>(program_invocation_short_name),
                           ": cannot go on, perhaps for want of memory or threads\n"})
    if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
  ::_exit(static_cast<int>(Exit::internal));
}
void prepare_last_words() {
  std::set_terminate(end_with_last_words);
}
// What stands in this section runs before the libraries' own initialization.
[[gnu::used, gnu::section(".preinit_array")]] void (*const kFirst)() = prepare_last_words;
}  // namespace

Options::Options(const Program& program)
    : impl_(std::make_unique<Impl>(program.summary, program.tool)) {
  common.tool = program.tool;
  impl_->result = program.result;
  impl_->app.formatter(help_in_80_columns());
  part(Part::general);
  declare_general(program);
  declare_what_else_is_printed(program);
  part(Part::telling);
  declare_telling(program);
  part(Part::files);
  if (program.output_help)
    impl_->keep(impl_->add("-o,--output", common.output, "FILE", program.output_help),
                Effect::report, Impl::Is::output);
}

void Options::declare_general(const Program& program) {
  if (program.uses & kSeed)
    impl_->keep(impl_->add("--seed", common.seed, "N", "Seed of the random numbers; default 1")
                    ->check(whole_number()),
                Effect::picture);
  if (program.uses & kThreads)
    option("--threads", common.threads, "N", "Threads to use; default all cores", 0, 4096,
           Effect::speed);
  impl_->keep(impl_
                  ->add("--max-memory,--set max-memory", impl_->most_memory, "SIZE",
                        "Most memory that a file, film or grid may take; default three quarters of "
                        "the machine's")
                  ->check(size()),
              Effect::speed);
  if (program.output_help) {
    flag("--no-provenance", common.no_provenance, "Leave out where the file comes from",
         Effect::stored);
    side_output("--set dependencies", common.dependencies,
                "Write a rule for Make: what the result was made from; also -MF FILE");
    option("--set dependencies-target", common.target_, "NAME",
           "What that rule is for; default what -o names; also -MQ NAME", Effect::report);
  }
  static std::vector<std::string> none;
  impl_->add("--set", none, "NAME=VALUE", "One of the settings below")->take_all();
}

void Options::declare_what_else_is_printed(const Program& program) {
  CLI::App& app = impl_->app;
  const auto complete = [this](const std::string&) {
    throw Instead{[this] { return completion_script(common.tool); }};
  };
  impl_->keep(app.add_option_function<std::string>(
                     "--completion", complete,
                     "Print a script that completes these options in bash and exit")
                  ->type_name("bash")
                  ->check(one_of({"bash"})),
              Effect::report);
  app.set_help_flag("-h,--help", "Print this help and exit");
  const std::string commit =
      *program.commit ? fmt::format(" (commit {})", program.commit) : std::string();
  app.set_version_flag(
      "--version",
      fmt::format("{} {}{}\n{}", program.tool, TDPT_VERSION, commit, program.libraries),
      "Print the versions of the program and its libraries and exit");
}

void Options::declare_telling(const Program& program) {
  if (program.uses & kQuiet)
    flag("--quiet", common.quiet, "No progress and no notes on stderr", Effect::report);
  if (program.uses & kProgress)
    choice("--set progress", impl_->progress, {"auto", "json", "none"},
           "Progress on stderr: auto, a line on a terminal (the default); json, an object a line",
           Effect::report);
  flag("--explain", common.explain, "Print on stderr what was decided, why, and what it costs",
       Effect::report);
  flag("--json", common.json,
       "Print a summary as JSON on stdout (on stderr when the result goes to stdout)",
       Effect::report);
}

Options::~Options() = default;

void Options::part(Part part) {
  impl_->part = part;
  impl_->app.option_defaults()->group(title_of(part));
}

void Options::argument(const std::string& name, std::string& target, const std::string& help,
                       bool required) {
  impl_->keep(impl_->add(name, target, "FILE", help)->required(required), Effect::picture,
              Impl::Is::input);
}

void Options::arguments(const std::string& name, std::vector<std::string>& target,
                        const std::string& help) {
  impl_->keep(impl_->add(name, target, "FILE", help)->required(target.empty()), Effect::picture,
              Impl::Is::input);
}

void Options::input(const std::string& flags, std::string& target, const std::string& value_name,
                    const std::string& help) {
  impl_->keep(impl_->add(flags, target, value_name, help), Effect::picture, Impl::Is::input);
}

namespace {

// Of an option that may be repeated: what follows its value may be an argument.
CLI::Option* one_each_time(CLI::Option* option) {
  return option->expected(1)->take_all()->allow_extra_args(false);
}

}  // namespace

void Options::inputs(const std::string& flags, std::vector<std::string>& target,
                     const std::string& value_name, const std::string& help) {
  impl_->keep(one_each_time(impl_->add(flags, target, value_name, help)), Effect::picture,
              Impl::Is::input);
}

void Options::input_or_setting(const std::string& flags, std::string& target,
                               const std::string& value_name, const std::string& help,
                               const std::function<bool(const std::string&)>& is_file) {
  impl_->keep(impl_->add(flags, target, value_name, help), Effect::picture, Impl::Is::input,
              is_file);
}

void Options::option(const std::string& flags, std::string& target, const std::string& value_name,
                     const std::string& help, Effect effect) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(some_text()), effect);
}

void Options::option(const std::string& flags, std::vector<std::string>& target,
                     const std::string& value_name, const std::string& help, Effect effect) {
  impl_->keep(one_each_time(impl_->add(flags, target, value_name, help))->check(some_text()),
              effect);
}

void Options::option(const std::string& flags, int64_t& target, const std::string& value_name,
                     const std::string& help, int64_t lowest, int64_t highest, Effect effect) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), effect);
}

void Options::option(const std::string& flags, double& target, const std::string& value_name,
                     const std::string& help, double lowest, double highest, Effect effect) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), effect);
}

void Options::option(const std::string& flags, std::optional<double>& target,
                     const std::string& value_name, const std::string& help, double lowest,
                     double highest, Effect effect) {
  impl_->keep(impl_->add(flags, target, value_name, help)->check(within(lowest, highest)), effect);
}

void Options::limit(const std::string& name, double& target, double lowest, double highest) {
  CLI::Option* const option = impl_->add("--set " + name, target, fmt::format("{:.4g}", target), "")
                                  ->check(within(lowest, highest));
  impl_->keep(option, Effect::picture);
  option->group(kLimits);
}

void Options::quality(Effect effect) {
  choice("--quality", impl_->quality, {"draft", "normal", "high"},
         "Speed or accuracy; default normal", effect);
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
                     Effect effect) {
  impl_->keep(impl_->add(flags, target, fmt::format("{}", fmt::join(words, "|")), help)
                  ->check(one_of(words)),
              effect);
}

void Options::side_output(const std::string& flags, std::string& target, const std::string& help) {
  impl_->keep(impl_->add(flags, target, "FILE", help), Effect::report, Impl::Is::side_output);
}

void Options::file(const std::string& flags, std::string& target, const std::string& help,
                   const std::function<Use()>& use) {
  impl_->keep(impl_->add(flags, target, "FILE", help), Effect::report);
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
  impl_->keep(flag, Effect::report);
  impl_->besides.push_back({flag, &target, path_of});
}

void Options::result_name(const std::function<void(const std::string&)>& check) {
  impl_->check_name = check;
}

void Options::result_is_text(const std::function<bool()>& is_text) {
  impl_->is_text = is_text;
}

void Options::flag(const std::string& flags, bool& target, const std::string& help, Effect effect) {
  impl_->keep(impl_->app.add_flag(flags, target, help), effect);
}

void Options::instead(const std::string& flags, const std::function<std::string()>& text,
                      const std::string& help) {
  impl_->keep(impl_->app.add_flag_callback(
                  flags, [text] { throw Instead{text}; }, help),
              Effect::report);
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
  // Output may still be in a buffer, or may have failed when the buffer was flushed: a full disk
  // shows here.
  const auto flushed = [&](int code) {
    if ((std::fflush(stdout) == 0 && !std::ferror(stdout)) || code != 0) return code;
    return fail(Exit::output, "(standard output): cannot be written");
  };
  const auto print = [&](const std::string& text) {
    std::fputs(text.c_str(), stdout);
    return flushed(0);
  };
  open_standard_streams();
  std::signal(SIGXFSZ, SIG_IGN);  // beyond `ulimit -f` writing fails and says so
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
    common.command = common.canonical();
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
