// Files that appear under their final name only when they are complete.
#pragma once
#include <string>
#include <string_view>

namespace tdpt {

/// Writes `bytes` to `path` ("-": standard output): a temporary file in the same folder, flushed to
/// disk, then renamed. Throws OutputError; then nothing is left behind and an older file of that
/// name is untouched. A read-only file is not
/// replaced. A path that is no regular file (/dev/null, a pipe) is written directly.
void write_output(const std::string& path, std::string_view bytes);

/// Throws OutputError when write_output(path) is bound to fail (no such folder, no permission, name
/// too long) and UsageError for an empty name: asked before long work, so that its result is not
/// lost.
void check_output(const std::string& path);

}  // namespace tdpt
