#include "libcommon/cli/options_impl.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/nearest.h"

namespace tdpt::cli {

namespace {

// CLI11 knows a setting as an option named "--set.walks", in a group of its own.
constexpr const char* kSetting = "--set.";
constexpr const char* kSettings = "Settings that few need, each given as --set NAME=VALUE";

// Its name, "walks"; empty for an ordinary option.
std::string setting_name(const CLI::Option* option) {
  if (option->get_lnames().empty()) return "";
  const std::string last = "--" + option->get_lnames().back();
  return last.starts_with(kSetting) ? last.substr(std::string(kSetting).size()) : "";
}

// "--set walks" for people; "--set.walks" for CLI11.
std::string for_people(const std::string& text) {
  return replaced(text, kSetting, "--set ");
}

std::string name_of(const CLI::Option* option) {
  return option->get_lnames().empty() ? option->get_name()
                                      : for_people("--" + option->get_lnames().front());
}

}  // namespace

std::string for_cli11(const std::string& text) {
  return replaced(text, "--set ", kSetting);
}

void Options::Impl::keep(CLI::Option* option, Effect effect, Is is,
                         std::function<bool(const std::string&)> is_file) {
  if (!setting_name(option).empty()) option->group(kSettings);
  entries.push_back({option, effect, part, is, std::move(is_file)});
}

std::vector<std::string> Options::Impl::settings() const {
  std::vector<std::string> names;
  for (const Entry& e : entries)
    if (const std::string name = setting_name(e.option); !name.empty()) names.push_back(name);
  return names;
}

std::vector<std::string> Options::Impl::with_settings(const std::vector<std::string>& given) const {
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

void Options::Impl::set_quality(Common& given) const {
  if (!quality.empty())
    given.quality = quality == "draft"  ? Quality::draft
                    : quality == "high" ? Quality::high
                                        : Quality::normal;
  for (const auto& knob : knobs) knob(given.quality);
}

void Options::Impl::limit(int threads) const {
  limit_threads(threads);
  if (const auto bytes = parse_size(most_memory)) limit_memory(*bytes);
}

void Options::Impl::spare_terminal(const std::string& path) const {
  if (path != "-" || result == Result::text || (is_text && is_text())) return;
  if (::isatty(STDOUT_FILENO))
    throw UsageError(
        "the result is binary and standard output is a terminal: name a file with -o FILE, or "
        "send it to a file or a pipe");
}

std::vector<NamedFile> Options::Impl::files(Is is) const {
  std::vector<NamedFile> files;
  for (const Entry& e : entries)
    if ((e.use ? e.use() : e.is) == is)
      for (const std::string& path : e.option->results())
        if (!e.is_file || e.is_file(path)) files.push_back({name_of(e.option), path});
  return files;
}

std::vector<std::string> Options::Impl::inputs() const {
  std::vector<std::string> paths;
  for (const NamedFile& file : files(Is::input)) paths.push_back(file.path);
  if (std::count(paths.begin(), paths.end(), "-") > 1)
    throw UsageError("only one input can be the standard input");
  return paths;
}

std::vector<NamedFile> Options::Impl::outputs(const std::string& path) const {
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

bool Options::Impl::is_given(const std::string& name) const {
  const CLI::Option* option = app.get_option_no_throw(name);
  return option && option->count() > 0;
}

std::vector<Given> Options::Impl::given() const {
  std::vector<Given> all;
  for (const Entry& e : entries) {
    if (e.option->count() == 0 || e.option->get_lnames().empty()) continue;
    Given& one = all.emplace_back(Given{name_of(e.option), {}, e.effect, e.part});
    if (e.option->get_items_expected_max() > 0) one.values = e.option->results();
    one.names_input = e.is == Is::input && (!e.is_file || e.is_file(one.values[0]));
  }
  return all;
}

std::vector<Completed> Options::Impl::completed() const {
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

std::string Options::Impl::fault(const CLI::ParseError& error) const {
  const int code = error.get_exit_code();
  if (code == static_cast<int>(CLI::ExitCodes::ExtrasError) ||
      code == static_cast<int>(CLI::ExitCodes::RequiredError))
    for (const std::string& given : app.remaining())
      if (given.size() > 1 && given[0] == '-') return no_such_option(given);
  return for_people(error.what());
}

std::string Options::Impl::no_such_option(const std::string& given) const {
  const std::string option = given.substr(0, given.find('='));
  std::vector<std::string> names, known = settings();
  for (const CLI::Option* each : app.get_options())
    for (const std::string& name : each->get_lnames()) names.push_back(name);
  names.insert(names.end(), known.begin(), known.end());
  const size_t start = std::min(option.find_first_not_of('-'), option.size());
  const std::string meant = option_meant(option.substr(start), names);
  const char* dashes = app.get_option_no_throw("--" + meant) ? "--" : "--set ";
  return fmt::format("{}: no such option{}", for_people(option),
                     meant.empty() ? "" : fmt::format(" (did you mean {}{}?)", dashes, meant));
}

CLI::Validator whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        const bool digits =
            !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        errno = 0;
        if (digits) std::strtoull(text.c_str(), nullptr, 10);
        if (digits && errno == 0) return std::string();
        return fmt::format("'{}' given, expected a number from 0 to {}", text, ~uint64_t{0});
      },
      "");
}

CLI::Validator size() {
  return CLI::Validator(
      [](std::string& text) {
        if (parse_size(text)) return std::string();
        return fmt::format("'{}' given, expected bytes, or a number with K, M, G or T", text);
      },
      "");
}

CLI::Validator some_text() {
  return CLI::Validator(
      [](std::string& text) {
        return text.empty() ? std::string("'' given, expected a value") : std::string();
      },
      "");
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& text) {
        for (const std::string& word : words)
          if (text == word) return std::string();
        const std::string meant = nearest(text, words);
        return fmt::format("'{}' given, expected one of {}{}", text, fmt::join(words, ", "),
                           meant.empty() ? "" : " (did you mean " + meant + "?)");
      },
      "");
}

namespace {

constexpr size_t kWidth = 80, kRight = 30;  ///< columns; start of the right column

// Titles, indexed by Part.
constexpr const char* kTitles[]{"What goes in and what comes out",
                                "How long and how good",
                                "What the picture holds",
                                "Camera",
                                "Animation",
                                "Sky and lamps",
                                "Long renders and many machines",
                                "What is told of the work",
                                "General"};

// Breaks `text` into lines that end before kWidth; the first begins at column `at`, the others at
// `indent`. A word longer than a line gets its own.
std::string wrapped(const std::string& text, size_t at, size_t indent) {
  std::string lines, word;
  std::istringstream words(text);
  bool first = true;
  while (words >> word) {
    if (!first && at + 1 + word.size() > kWidth) {
      lines += "\n" + std::string(indent, ' ');
      at = indent;
      first = true;
    }
    lines += (first ? "" : " ") + word;
    at += (first ? 0 : 1) + word.size();
    first = false;
  }
  return lines + "\n";
}

class In80Columns : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool positional) const override {
    const std::string setting = setting_name(option);
    if (setting.empty())
      return line("  " + make_option_name(option, positional) + make_option_opts(option),
                  make_option_desc(option));
    const std::string& flag = option->get_lnames().front();
    return line("  " + setting + "=" + option->get_type_name(),
                make_option_desc(option) + (flag == setting ? "; also --" + flag : ""));
  }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    std::string text = make_description(app) + make_usage(app, name) + make_positionals(app);
    const auto add = [&](const std::string& title) {
      const auto options = app->get_options([&](const CLI::Option* option) {
        return option->nonpositional() && option->get_group() == title;
      });
      if (!options.empty()) text += make_group(title, false, options);
    };
    for (const char* title : kTitles) add(title);
    add(kSettings);
    return text + limits_of(app);
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0, 0);
  }

 private:
  // Names and defaults.
  static std::string limits_of(const CLI::App* app) {
    std::string all;
    for (const CLI::Option* option : app->get_options())
      if (option->get_group() == kLimits)
        all += setting_name(option) + "=" + option->get_type_name() + " ";
    return all.empty()
               ? ""
               : "\n" + wrapped(kLimits + std::string(":"), 0, 0) + "  " + wrapped(all, 2, 2);
  }
  static std::string line(std::string left, const std::string& right) {
    if (left.size() >= kRight)
      left += "\n" + std::string(kRight, ' ');
    else
      left.resize(kRight, ' ');
    return left + wrapped(right, kRight, kRight);
  }
};

}  // namespace

std::string title_of(Part part) {
  return kTitles[static_cast<size_t>(part)];
}

std::shared_ptr<CLI::FormatterBase> help_in_80_columns() {
  return std::make_shared<In80Columns>();
}

}  // namespace tdpt::cli
