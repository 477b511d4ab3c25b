#include "libcommon/base/file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <sys/stat.h>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"

namespace tdpt {

std::string display_name(const std::string& path) {
  return path == "-" ? "(standard input)" : path;
}

std::string read_file(const std::string& path) {
  const bool standard_input = path == "-";
  struct stat info {};
  if (!standard_input && ::stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode))
    throw InputError(path, "", "is a folder, expected a file");
  std::FILE* file = standard_input ? stdin : std::fopen(path.c_str(), "rb");
  if (!file) throw InputError(path, "", std::string("cannot be opened: ") + std::strerror(errno));
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> closer(standard_input ? nullptr : file,
                                                         std::fclose);
  std::string bytes;
  char buffer[1 << 16];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, file)) > 0;) {
    bytes.append(buffer, n);
    if (bytes.size() > memory_limit())
      throw InputError(display_name(path), "",
                       "is larger than the " + size_words(memory_limit()) + " of --max-memory");
  }
  if (std::ferror(file))
    throw InputError(display_name(path), "",
                     std::string("cannot be read: ") + std::strerror(errno));
  return bytes;
}

}  // namespace tdpt
