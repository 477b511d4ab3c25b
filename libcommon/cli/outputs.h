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

}  // namespace tdpt::cli
