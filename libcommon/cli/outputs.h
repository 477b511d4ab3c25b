// The outputs of a run against each other and against its inputs, asked before any work.
#pragma once
#include <string>
#include <vector>

namespace tdpt::cli {

/// A file that the command line names. "-": standard input or standard output.
struct NamedFile {
  std::string option;  ///< that names it, for messages
  std::string path;
};

/// Throws UsageError when two outputs are one file, by whatever way their names lead there
/// (folders, links symbolic or hard) and whether it exists yet or not, and where check_output
/// [base/output_file.h] does. Only -o may be "-".
void check_outputs(const std::vector<NamedFile>& outputs);
/// Throws UsageError when an output is one of the inputs, compared alike.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<std::string>& inputs);

/// For output_beside(): the name of the picture with .png; throws UsageError for standard output.
std::string png_beside(const std::string& picture);

}  // namespace tdpt::cli
