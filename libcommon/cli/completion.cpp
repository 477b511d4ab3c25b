#include "libcommon/cli/completion.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt::cli {
namespace {

std::string in_quotes(const std::string& text) {
  return "'" + replaced(text, "'", R"('\'')") + "'";
}

// All positional arguments merged into one: which of them is meant depends on the words before.
Completed all_arguments(const std::vector<Completed>& table) {
  Completed all;
  for (const Completed& c : table)
    if (c.argument()) {
      all.file = all.file || c.file;
      for (const std::string& suffix : c.suffixes)
        if (std::find(all.suffixes.begin(), all.suffixes.end(), suffix) == all.suffixes.end())
          all.suffixes.push_back(suffix);
    }
  return all;
}

// bash: the word to complete and the one before it decide. "--name=value" arrives as three words.

constexpr const char* kBashFiles = R"(  word=${word#[\"\']} word=${word//\\/}
  compopt -o filenames 2>/dev/null
  mapfile -t found < <(for suffix in "${suffixes[@]}"; do compgen -f -X "!*$suffix" -- "$word"; done)
  if [[ ${#found[@]} == 0 ]]; then mapfile -t found < <(compgen -f -- "$word"); fi
  mapfile -t folders < <(compgen -d -- "$word")
  COMPREPLY=("${folders[@]}" "${found[@]}")
)";

// Names of settings, to be followed by a value.
bool want_more(const std::vector<std::string>& words) {
  return !words.empty() && words.back().ends_with('=');
}

std::string bash_value(const Completed& c) {
  std::string set;
  if (!c.words.empty()) set += fmt::format(" words='{}'", fmt::join(c.words, " "));
  if (want_more(c.words)) set += "; compopt -o nospace 2>/dev/null";
  if (c.file) set += fmt::format(" files=1 suffixes=({})", fmt::join(c.suffixes, " "));
  return set.empty() ? " return" : set;
}

std::string bash_script(const std::string& tool, const std::vector<Completed>& table) {
  const std::string function = "_" + replaced(tool, "-", "_");
  std::string values, names;
  for (const Completed& c : table) {
    if (c.argument()) continue;
    if (c.setting.empty()) {
      names += fmt::format("{}{}", names.empty() ? "" : " ", fmt::join(c.names, " "));
      if (!c.value.empty())
        values += fmt::format("  {}){} ;;\n", fmt::join(c.names, " | "), bash_value(c));
    } else {
      values += fmt::format("  {}){} ;;\n", c.setting, bash_value(c));
    }
  }
  return fmt::format(
      "{0}() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  local words='' files='' suffixes=() suffix found folders\n"
      "  COMPREPLY=()\n"
      "  if [[ $word == = ]]; then\n"
      "    word=''\n"
      "  elif [[ $before == = ]]; then\n"
      "    before=${{COMP_WORDS[COMP_CWORD - 2]}}\n"
      "  fi\n"
      "  case $before in\n"
      "{1}"
      "  *)\n"
      "    case $word in\n"
      "    -*) words='{2}' ;;\n"
      "    *){3} ;;\n"
      "    esac\n"
      "    ;;\n"
      "  esac\n"
      "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
      "  if [[ -z $files || ${{#COMPREPLY[@]}} != 0 ]]; then return; fi\n"
      "{4}"
      "}}\n"
      "complete -F {0} {5}\n",
      function, values, names, bash_value(all_arguments(table)), kBashFiles, tool);
}

// zsh: one specification for each name, in the syntax of _arguments.

std::string zsh_value(const Completed& c) {
  std::string action = " ";
  std::string patterns;
  for (const std::string& suffix : c.suffixes)
    patterns += (patterns.empty() ? "" : "|") + suffix.substr(1);
  if (!c.words.empty()) action = fmt::format("({})", fmt::join(c.words, " "));
  if (want_more(c.words)) action = fmt::format("compadd -S \"\" {}", fmt::join(c.words, " "));
  if (c.file) action = patterns.empty() ? "_files" : fmt::format("_files -g \"*.({})\"", patterns);
  return ":" + replaced(c.argument() ? c.names.front() : c.value, ":", "\\:") + ":" + action;
}

std::string zsh_script(const std::string& tool, const std::vector<Completed>& table) {
  std::string script = fmt::format("#compdef {}\n_arguments -s -S", tool);
  for (const Completed& c : table) {
    const std::string value = c.value.empty() ? "" : zsh_value(c);
    if (c.argument()) {
      script += " \\\n  " + in_quotes(value);
      continue;
    }
    if (!c.setting.empty()) continue;
    const std::string help = replaced(replaced(c.help, "[", "\\["), "]", "\\]");
    for (const std::string& name : c.names) {
      const bool is_long = name.starts_with("--");
      script +=
          " \\\n  " +
          in_quotes(fmt::format(
              "{}{}{}[{}]{}", c.repeated ? "*" : fmt::format("({})", fmt::join(c.names, " ")), name,
              value.empty() ? ""
              : is_long     ? "="
                            : "+",
              help, value));
    }
  }
  return script + "\n";
}

// fish: one command per option. __fish_complete_suffix lists the files with the suffix first, then
// all others.

std::string fish_quotes(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_value(const Completed& c) {
  if (!c.suffixes.empty())
    return fmt::format(" -k -x -a '(for s in {}; __fish_complete_suffix $s; end)'",
                       fmt::join(c.suffixes, " "));
  if (!c.words.empty()) return fmt::format(" -x -a '{}'", fmt::join(c.words, " "));
  return c.file ? " -r -F" : " -x";
}

std::string fish_script(const std::string& tool, const std::vector<Completed>& table) {
  std::string script = fmt::format("complete -c {}{}\n", tool, fish_value(all_arguments(table)));
  for (const Completed& c : table) {
    if (c.argument() || !c.setting.empty()) continue;
    script += "complete -c " + tool;
    for (const std::string& name : c.names)
      script += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    script += (c.value.empty() ? "" : fish_value(c)) + " -d " + fish_quotes(c.help) + "\n";
  }
  return script;
}

}  // namespace

std::vector<std::string> words_of(const std::string& value) {
  std::vector<std::string> words;
  for (size_t start = 0; start < value.size();) {
    const size_t end = std::min(value.find('|', start), value.size());
    std::string word = value.substr(start, end - start);
    word = word.substr(0, word.find('['));
    if (!word.empty() && std::islower(static_cast<unsigned char>(word[0]))) words.push_back(word);
    start = end + 1;
  }
  return words;
}

std::vector<std::string> suffixes_in(const std::string& help) {
  std::vector<std::string> suffixes;
  for (size_t at = 0; (at = help.find('.', at)) != std::string::npos; ++at) {
    if (at == 0 || (help[at - 1] != ' ' && help[at - 1] != '(')) continue;
    size_t end = at + 1;
    while (end < help.size() && std::islower(static_cast<unsigned char>(help[end]))) ++end;
    if (end > at + 1) suffixes.push_back(help.substr(at, end - at));
  }
  return suffixes;
}

std::string completion_script(const std::string& shell, const std::string& tool,
                              const std::vector<Completed>& table) {
  const std::string head = fmt::format(
      "# Completion of {0} for {1}, from its options: {0} --completion {1}\n", tool, shell);
  if (shell == "bash") return head + bash_script(tool, table);
  if (shell == "fish") return head + fish_script(tool, table);
  const std::string script = zsh_script(tool, table);  // its first line (#compdef) identifies it
  return script.substr(0, script.find('\n') + 1) + head + script.substr(script.find('\n') + 1);
}

}  // namespace tdpt::cli
