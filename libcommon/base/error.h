// The one exception family of the toolchain. Readers and algorithms throw; run_main (cli/) catches
// once and prints one line "tool: file:place: message".
#pragma once
#include <stdexcept>
#include <string>

namespace tdpt {

/// Exit codes, the same in every tool.
enum class Exit {
  done = 0,
  internal = 1,
  usage = 2,
  bad_input = 3,
  output = 4,
  no_device = 5,
  interrupted = 6,
};

struct Error : std::runtime_error {
  Error(Exit code_, const std::string& message) : std::runtime_error(message), code(code_) {}
  Exit code;
};

/// Something is wrong in an input file. `place` says where in it: "line 7", "accessors[3]"; empty:
/// the file as a whole.
struct InputError : Error {
  explicit InputError(const std::string& line) : Error(Exit::bad_input, line) {}  ///< all of it
  InputError(const std::string& file, const std::string& place, const std::string& message)
      : Error(Exit::bad_input, file + ":" + (place.empty() ? "" : place + ":") + " " + message) {}
};

struct UsageError : Error {
  explicit UsageError(const std::string& message) : Error(Exit::usage, message) {}
};

struct OutputError : Error {
  OutputError(const std::string& file, const std::string& message)
      : Error(Exit::output, file + ": " + message) {}
};

}  // namespace tdpt
