// Files that appear under their final name only when they are complete.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

/// Writes `bytes` to `path` ("-": standard output): a temporary file in the same folder, flushed to
/// disk, then renamed, then the folder flushed: whenever the process or the machine ends, the path
/// is the older file or all of the new one. Throws OutputError; then nothing is left behind and an
/// older file of that name is untouched. A read-only file is not replaced. A path that is no
/// regular file (/dev/null, a pipe) is written directly.
void write_output(const std::string& path, std::string_view bytes);

struct OutputFile {
  std::string path, bytes;
};

/// Writes all of the files or, as far as the system allows, none: each as write_output, but only
/// when all are on disk under temporary names do they get their own, the first file last. Whoever
/// finds the first has all of them. What cannot be taken back (standard output, a pipe) is written
/// when the rest is on disk. Throws OutputError.
void write_outputs(const std::vector<OutputFile>& files);

/// For what took long to make and cannot be written where it should be: a file of a name like
/// `name`, with something unique before its suffix, in the folder for temporary files or else in
/// that of the user. Its path; "" where that cannot be written either.
std::string keep_elsewhere(const std::string& name, std::string_view bytes);

/// Throws OutputError when write_output(path) is bound to fail (no such folder, no permission, name
/// too long) and UsageError for an empty name: asked before long work, so that its result is not
/// lost.
void check_output(const std::string& path);

}  // namespace tdpt
