// What the programs of a chain have told of the files that all of them read, so that each thing is
// told once: tdpt.mk names a file for that, a line for each.
#pragma once
#include <string>

namespace tdpt::cli {

/// Whether no other program has told it yet; from now on it has been. Always true outside of a
/// chain, where the environment has no TDPT_TOLD, and where the file that it names cannot be used.
bool is_news(const std::string& file, const std::string& sentence);

}  // namespace tdpt::cli
