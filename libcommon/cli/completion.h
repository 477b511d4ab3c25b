// Scripts for shell completion of a program's options.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// What a shell needs to know about an option or argument.
struct Completed {
  std::vector<std::string> names;     ///< with their dashes; of an argument its name in --help
  std::string help;                   ///< what it does
  std::string value;                  ///< name of its value in --help; empty: none
  std::vector<std::string> words;     ///< possible values
  bool file = false;                  ///< whether the value can be a file
  std::vector<std::string> suffixes;  ///< of such a file, ".glb"; empty: any
  bool repeated = false;
  std::string setting{};  ///< its name for `--set`; empty: it is an option

  bool argument() const { return names.front().front() != '-'; }
};

/// The literal words of a value's name in --help: cpu, gpu of "cpu|gpu[:WHICH]". Capitals are
/// placeholders.
std::vector<std::string> words_of(const std::string& value);

/// The suffixes that a help text names, as in "Scene (.glb, .gltf)".
std::vector<std::string> suffixes_in(const std::string& help);

/// The script for "bash", "zsh" or "fish".
std::string completion_script(const std::string& shell, const std::string& tool,
                              const std::vector<Completed>& table);

}  // namespace tdpt::cli
