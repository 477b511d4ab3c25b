// Shared by the libFuzzer targets: a reader gets bytes and must either read them or refuse them
// with a one-line error. Anything else ends the program, which libFuzzer and fuzz_replay detect.
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/testing/files/temp_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace tdpt::testing {

inline void require(bool holds, const std::string& promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise.c_str());
  std::abort();
}

/// The input as text.
inline std::string_view text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Path of a file with these bytes, always the same, in TMPDIR.
inline std::string file_of(std::string_view bytes) {
  static const TempFolder folder;
  static const std::string path = folder.write("input", "");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  require(file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() &&
              std::fclose(file) == 0,
          "TMPDIR has room for an input");
  return path;
}

/// Whether `read` accepts its input; false if it refuses with one line. Other exceptions propagate.
/// Valid but large files are refused, too: libFuzzer cannot tell them from
/// malicious ones.
template <class Read>
bool reads(const Read& read) {
  limit_memory(uint64_t{400} << 20);
  try {
    read();
  } catch (const InputError& e) {
    require(std::string_view(e.what()).find_first_of("\r\n") == std::string_view::npos,
            std::string("a message is one line: ") + e.what());
    return false;
  }
  return true;
}

}  // namespace tdpt::testing
