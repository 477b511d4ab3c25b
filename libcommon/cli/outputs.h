// Checks the outputs of a run against each other and against its inputs, before any work.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// A file named on the command line. "-": standard input or standard output.
struct NamedFile {
  std::string option;  ///< that names it, for messages
  std::string path;
};

/// Throws UsageError if two outputs are the same file, whether it exists yet or not and by whatever
/// path (folders, symbolic or hard links), and whatever check_output [base/output_file.h] throws.
/// Only -o may be "-".
void check_outputs(const std::vector<NamedFile>& outputs);
/// Throws UsageError if an output is one of the inputs, compared in the same way.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<std::string>& inputs);

/// For output_beside(): the name of the picture with .png; throws UsageError for standard output.
std::string png_beside(const std::string& picture);

// Dependency files as compilers write them with -MF: a Make rule that lists what a result was made
// from.

/// The command line without the program, with -MF FILE and -MQ TARGET (also as one word) replaced
/// by the settings that they stand for: CLI11 takes a single dash for a single letter.
std::vector<std::string> without_short_forms(int argc, const char* const* argv);

/// Throws UsageError for a name that Make cannot express: with ;, a tab or a line break, with a
/// trailing backslash, or of the form archive(member).
void check_make_name(const std::string& name);

/// "target: inputs" without a recipe, then an empty rule for each input: if one of them is gone,
/// the target is out of date, and Make does not ask for a rule to make the input. Names are quoted
/// for GNU Make; "-" and duplicates are left out.
std::string make_rule(const std::string& target, const std::vector<std::string>& read);

}  // namespace tdpt::cli
