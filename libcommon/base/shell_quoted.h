// Words of commands that people copy into a shell.
#pragma once
#include <string>

namespace tdpt {

/// `word` itself, or in single quotes if a shell would split or expand it.
std::string shell_quoted(const std::string& word);

}  // namespace tdpt
