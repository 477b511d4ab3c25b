// Scripts that teach a shell to complete the options of a program.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// What a shell is told of an option, or of an argument.
struct Completed {
  std::vector<std::string> names;     ///< with their dashes; of an argument what --help calls it
  std::string help;                   ///< what it does
  std::string value;                  ///< what --help calls its value; empty: it has none
  std::vector<std::string> words;     ///< that the value can be
  bool file = false;                  ///< the value is, or can be, a file
  std::vector<std::string> suffixes;  ///< that such a file has, ".glb"; none: any
  bool repeated = false;
  std::string setting{};  ///< what `--set` calls it; empty: it is an option

  bool argument() const { return names.front().front() != '-'; }
};

/// The words of a value that --help calls "cpu|gpu[:WHICH]": cpu, gpu. Capitals stand for what is
/// no word.
std::vector<std::string> words_of(const std::string& value);

/// The suffixes that a help text names, as in "Scene (.glb, .gltf)".
std::vector<std::string> suffixes_in(const std::string& help);

/// The script for "bash", "zsh" or "fish".
std::string completion_script(const std::string& shell, const std::string& tool,
                              const std::vector<Completed>& table);

}  // namespace tdpt::cli
