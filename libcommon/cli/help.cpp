#include "libcommon/cli/help.h"

#include <sstream>
#include <string>

namespace tdpt::cli {
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

const char* const kSettings = "Settings that few need, each given as --set NAME=VALUE";
const char* const kLimits =
    "Limits that verdicts hang on, each given as --set NAME=VALUE; the manual explains them";

std::string title_of(Part part) {
  return kTitles[static_cast<size_t>(part)];
}

std::string setting_name(const CLI::Option* option) {
  if (option->get_lnames().empty()) return "";
  const std::string last = "--" + option->get_lnames().back();
  return last.starts_with(kSetting) ? last.substr(std::string(kSetting).size()) : "";
}

std::shared_ptr<CLI::FormatterBase> help_in_80_columns() {
  return std::make_shared<In80Columns>();
}

}  // namespace tdpt::cli
