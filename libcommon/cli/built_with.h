// What a program was built from and with, for --version. Each executable defines its own, so that a
// new commit recompiles and relinks nothing else [cmake/libraries.cmake].
#pragma once

namespace tdpt::cli {

extern const char kLibraries[];  ///< one library and its version per line
extern const char kCommit[];     ///< of the git checkout, abbreviated; empty without one

}  // namespace tdpt::cli
