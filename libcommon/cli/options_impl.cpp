#include "libcommon/cli/options_impl.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"

namespace tdpt::cli {

namespace {

// CLI11 knows a setting as an option named "--set.walks", in a group of its own.
constexpr const char* kSetting = "--set.";

// "--set walks" for people; "--set.walks" for CLI11.
std::string for_people(const std::string& text) {
  return replaced(text, kSetting, "--set ");
}

std::string name_of(const CLI::Option* option) {
  return option->get_lnames().empty() ? option->get_name()
                                      : for_people("--" + option->get_lnames().front());
}

// The number of letters to insert, delete, replace or swap with the next: the optimal string
// alignment distance. row[j]: distance between the first i letters of a and the first j of b.
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> before_last, last, row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

// " (did you mean --WORD?)" for the nearest of `words`, with one slip in three letters at most;
// else nothing.
std::string suggestion(const std::string& given, const std::vector<std::string>& words,
                       const char* dashes = "") {
  if (given.size() < 2 || given.size() > 64) return "";
  size_t least = std::max<size_t>(1, given.size() / 3) + 1;
  std::string found;
  for (const std::string& word : words)
    if (const size_t d = edit_distance(given, word); d < least) least = d, found = word;
  return found.empty() ? "" : for_people(fmt::format(" (did you mean {}{}?)", dashes, found));
}

}  // namespace

std::string setting_name(const CLI::Option* option) {
  if (option->get_lnames().empty()) return "";
  const std::string last = "--" + option->get_lnames().back();
  return last.starts_with(kSetting) ? last.substr(std::string(kSetting).size()) : "";
}

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
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw UsageError(fmt::format("--set {}: no such setting, expected one of {}{}", text,
                                   fmt::join(known, ", "), suggestion(name, known)));
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
  std::vector<std::string> names;
  for (const CLI::Option* each : app.get_options())
    for (const std::string& name : each->get_lnames()) names.push_back(name);
  const size_t start = std::min(option.find_first_not_of('-'), option.size());
  return fmt::format("{}: no such option{}", for_people(option),
                     suggestion(option.substr(start), names, "--"));
}

CLI::Validator expecting(const std::string& expected,
                         const std::function<bool(const std::string&)>& is_valid) {
  return CLI::Validator(
      [=](std::string& text) {
        return is_valid(text) ? "" : fmt::format("'{}' given, expected {}", text, expected);
      },
      "");
}

CLI::Validator whole_number() {
  return expecting(fmt::format("a number from 0 to {}", ~uint64_t{0}), [](const std::string& text) {
    uint64_t number = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
    return failed == std::errc() && end == text.data() + text.size();
  });
}

CLI::Validator size() {
  return expecting("bytes, or a number with K, M, G or T",
                   [](const std::string& text) { return parse_size(text).has_value(); });
}

CLI::Validator some_text() {
  return expecting("a value", [](const std::string& text) { return !text.empty(); });
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return fmt::format("'{}' given, expected one of {}{}", text, fmt::join(words, ", "),
                           suggestion(text, words));
      },
      "");
}

}  // namespace tdpt::cli
