// Files that appear under their final name only when they are complete.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

/// Writes `bytes` to `path` ("-": standard output): a temporary file in the same folder is flushed
/// to disk, then renamed, then the folder is flushed. So whenever the process or the machine stops,
/// the path holds either the old file or the complete new one. Throws OutputError; then nothing is
/// left behind and an older file of that name is untouched. A read-only file is not replaced. A
/// path that is no regular file (/dev/null, a pipe) is written directly.
void write_output(const std::string& path, std::string_view bytes);

struct OutputFile {
  std::string path, bytes;
};

/// Writes all of the files or, as far as the system allows, none. Each is written as by
/// write_output, but they are renamed only when all are on disk, the first file last: if the first
/// is there, all are. What cannot be taken back (standard output, a pipe) is written after
/// everything else is on disk. Throws OutputError.
void write_outputs(const std::vector<OutputFile>& files);

/// Saves a costly result that cannot be written where it should be: under a name like `name`, with
/// a unique part before the suffix, in the folder for temporary files or else in the user's home.
/// Returns its path; "" if that fails, too.
std::string keep_elsewhere(const std::string& name, std::string_view bytes);

/// Throws OutputError if write_output(path) is bound to fail (no such folder, no permission, name
/// too long), and UsageError for an empty name. Call it before long work, so that the result is not
/// lost.
void check_output(const std::string& path);

}  // namespace tdpt
