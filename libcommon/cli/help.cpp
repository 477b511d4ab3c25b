// What a program tells of its options: --help in lines of 80 columns, and completion in bash.
#include <sstream>
#include <string>

#include "libcommon/base/words.h"
#include "libcommon/cli/options_impl.h"

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

std::string title_of(Part part) {
  return kTitles[static_cast<size_t>(part)];
}

std::shared_ptr<CLI::FormatterBase> help_in_80_columns() {
  return std::make_shared<In80Columns>();
}

std::string completion_script(const std::string& tool) {
  // The word before the cursor selects an entry of --help, each joined into one line. Its value has
  // words in small letters, "cpu|gpu[:WHICH]", or is a FILE, or one whose suffixes the text names.
  // bash splits "--name=value" into three words.
  constexpr const char* kScript =
      R"bash(# Completes the options of TOOL in bash: TOOL --completion bash
_FUNCTION() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local help entry='' value='' words='' suffix found folders
  COMPREPLY=()
  if [[ $word == = ]]; then
    word=''
  elif [[ $before == = ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  help=$("${1/#\~/$HOME}" --help 2>/dev/null | sed -E ':join;N;$!bjoin;s/\n {3,}/  /g') || return
  [[ ! $before =~ ^[a-z-]+$ ]] || entry=$(grep -E -m 1 -- "^  (-.,)?$before([ ,=]|$)" <<<"$help")
  [[ ! $entry =~ ^\ \ [^\ =]+[\ =]([^\ ]+) ]] || value=${BASH_REMATCH[1]}
  if [[ $before == --set ]]; then
    words=$(sed -n '/^Settings\|^Limits/,$p' <<<"$help" | grep -oE '(^| )[a-z][a-z-]*=')
    compopt -o nospace 2>/dev/null
  elif [[ -n $value ]]; then
    words=$(tr '|' '\n' <<<"$value" | sed -nE 's/^([a-z][^[]*).*/\1/p')
  elif [[ $word == -* ]]; then
    words=$(grep -oE '^  -[^ ]+' <<<"$help" | tr , '\n')
  else
    entry=$(sed -n '/^Positionals/,/^$/p' <<<"$help") value=FILE
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  if [[ ${#COMPREPLY[@]} != 0 || $value != *FILE* && ! $entry =~ [\ \(]\.[a-z] ]]; then return; fi
  word=${word#[\"\']} word=${word//\\/}
  compopt -o filenames 2>/dev/null
  mapfile -t folders < <(compgen -d -- "$word")
  if [[ $before != -o && $before != --output ]]; then
    mapfile -t found < <(for suffix in $(grep -oE '[ (]\.[a-z]+' <<<"$entry" | tr -d ' ('); do
      compgen -f -X "!*$suffix" -- "$word"; done)
  fi
  if [[ ${#found[@]} == 0 ]]; then mapfile -t found < <(compgen -f -- "$word"); fi
  COMPREPLY=("${folders[@]}" "${found[@]}")
}
complete -F _FUNCTION TOOL
)bash";
  return replaced(replaced(kScript, "TOOL", tool), "FUNCTION", replaced(tool, "-", "_"));
}

}  // namespace tdpt::cli
