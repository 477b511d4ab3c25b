#include "libcommon/cli/dependencies.h"

#include <algorithm>
#include <string_view>

#include "libcommon/base/error.h"
#include "libcommon/base/shown.h"

namespace tdpt::cli {
namespace {

enum class Stands { as_target, as_prerequisite };

// GNU Make takes blanks, # and :, and the wildcards of file names, literally after a backslash;
// backslashes before such a one are doubled. A target with % would be a pattern, a prerequisite
// with | an order-only one. = and & begin an assignment and a group of targets, unless a function
// returns them. ~ is a home directory at the beginning only.
std::string make_name(const std::string& name, Stands stands) {
  const std::string_view quoted = stands == Stands::as_target ? " #:*?[]%" : " #:*?[]|";
  std::string text = name.starts_with('~') ? "./" : "";
  size_t backslashes = 0;
  for (const char c : name) {
    if (quoted.find(c) != std::string_view::npos) text += std::string(backslashes, '\\') + '\\';
    if (c == '=' || c == '&')
      text += std::string("$(if ,,") + c + ")";
    else if (c == '$')
      text += "$$";
    else
      text += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return text;
}

}  // namespace

std::vector<std::string> without_short_forms(int argc, const char* const* argv) {
  std::vector<std::string> words;
  bool options = true;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    options &= word != "--";
    const bool file = word.starts_with("-MF"), target = word.starts_with("-MQ");
    if (!options || !(file || target)) {
      words.push_back(word);
      continue;
    }
    words.emplace_back(file ? "--set.dependencies" : "--set.dependencies-target");
    if (word.size() > 3) words.push_back(word.substr(3));
  }
  return words;
}

void check_make_name(const std::string& name) {
  const bool member = name.ends_with(')') && name.find('(') != std::string::npos;
  if (member || name.ends_with('\\') || name.find_first_of(";\t\n\r") != std::string::npos)
    throw UsageError("-MF: Make has no way to write the name " + shown(name, 200));
}

std::string make_rule(const std::string& target, const std::vector<std::string>& read) {
  std::vector<std::string> files;
  for (const std::string& file : read)
    if (file != "-" && std::find(files.begin(), files.end(), file) == files.end())
      files.push_back(file);
  std::string text = make_name(target, Stands::as_target) + ":";
  for (const std::string& file : files)
    text += " \\\n  " + make_name(file, Stands::as_prerequisite);
  text += "\n";
  for (const std::string& file : files) text += "\n" + make_name(file, Stands::as_target) + ":\n";
  return text;
}

}  // namespace tdpt::cli
