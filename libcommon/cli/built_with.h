// What a program was built from and with, for --version. Each executable has its own, so that a new
// commit compiles and links nothing else [cmake/libraries.cmake].
#pragma once

namespace tdpt::cli {

extern const char kLibraries[];  ///< a library and its version a line
extern const char kCommit[];     ///< of the git checkout, abbreviated; empty where it was none

}  // namespace tdpt::cli
