#include "libcommon/base/file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>

#include <sys/stat.h>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"

namespace tdpt {

std::string display_name(const std::string& path) {
  return path == "-" ? "(standard input)" : path;
}

namespace {

constexpr size_t kBlock = 1 << 16;

// Whether a stream that begins so may never end: binary data of no kind that is read here
// (/dev/zero), or one line over and over (yes).
bool is_noise(std::string_view beginning) {
  for (const char* magic : {"glTF", "\x76\x2f\x31\x01", " BDV", "#?"})  // glTF, EXR, VDB, HDR
    if (beginning.starts_with(magic)) return false;
  const size_t line = std::min(beginning.find('\n'), beginning.size() - 1) + 1;
  return beginning.find('\0') != beginning.npos ||
         (beginning.size() == kBlock && line < kBlock / 2 &&
          beginning.substr(line) == beginning.substr(0, kBlock - line));
}

}  // namespace

std::string read_file(const std::string& path) {
  const bool standard_input = path == "-";
  std::FILE* file = standard_input ? stdin : std::fopen(path.c_str(), "rb");
  if (!file) throw InputError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> closer(standard_input ? nullptr : file,
                                                         std::fclose);
  struct stat info {};
  const bool known = ::fstat(::fileno(file), &info) == 0;
  if (known && S_ISDIR(info.st_mode))
    throw InputError(display_name(path), "", "is a folder, expected a file");
  const bool ends = known && S_ISREG(info.st_mode);
  const auto expect_room = [&](uint64_t size) {
    if (size > memory_limit())
      throw InputError(display_name(path), "",
                       "is larger than the " + size_words(memory_limit()) + " of --max-memory");
  };
  std::string bytes;
  if (ends) {
    expect_room(static_cast<uint64_t>(info.st_size));
    bytes.reserve(static_cast<size_t>(info.st_size));
  }
  char buffer[kBlock];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) {
    // A string that grows is there twice while it is copied.
    const bool grows = bytes.size() + n > bytes.capacity();
    expect_room(bytes.size() + n + (grows ? bytes.capacity() : 0));
    const bool is_first = bytes.empty();
    bytes.append(buffer, n);
    if (is_first && !ends && is_noise(bytes)) break;
  }
  if (std::ferror(file))
    throw InputError(display_name(path), "",
                     std::string("cannot be read: ") + std::strerror(errno));
  return bytes;
}

}  // namespace tdpt
