#include "libcommon/cli/help.h"

#include <sstream>
#include <string>

namespace tdpt::cli {
namespace {

constexpr size_t kWidth = 80, kRight = 30;  ///< columns; where the right half begins

// `text` in lines that end before kWidth, the first of which begins at column `at`, the others at
// `indent`. A word that is longer than a line has one alone.
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
    std::string left = "  " + make_option_name(option, positional) + make_option_opts(option);
    if (left.size() >= kRight)
      left += "\n" + std::string(kRight, ' ');
    else
      left.resize(kRight, ' ');
    return left + wrapped(make_option_desc(option), kRight, kRight);
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0, 0);
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_in_80_columns() {
  return std::make_shared<In80Columns>();
}

}  // namespace tdpt::cli
