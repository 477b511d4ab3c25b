// What the targets of libFuzzer share: a reader gets bytes, and reads them or refuses them with one
// line. Anything else ends the program, which libFuzzer and fuzz_replay notice.
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"
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

/// Path of a file of these bytes, each time the same. It lies in TMPDIR.
inline std::string file_of(std::string_view bytes) {
  static const TempFolder folder;
  static const std::string path = folder.write("input", "");
  std::FILE* file = std::fopen(path.c_str(), "wb");
  require(file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() &&
              std::fclose(file) == 0,
          "TMPDIR has room for an input");
  return path;
}

/// Whether `read` reads; false when it refuses, with one line. What else it throws goes through.
/// Files that are honest and large are refused, too: libFuzzer cannot tell them from others.
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
