// Avoids repeated messages in a chain of programs that read the same files: tdpt.mk names a file
// that records what was printed, one line each.
#pragma once
#include <string>

namespace tdpt::cli {

/// Whether no other program has printed this yet; records it. Always true outside of a chain (no
/// TDPT_TOLD in the environment), and if the file that it names cannot be used.
bool is_news(const std::string& file, const std::string& sentence);

}  // namespace tdpt::cli
