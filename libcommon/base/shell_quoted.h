// Words of commands that people copy into a shell.
#pragma once
#include <string>

namespace tdpt {

/// As it is, or in single quotes where a shell would take it apart.
std::string shell_quoted(const std::string& word);

}  // namespace tdpt
