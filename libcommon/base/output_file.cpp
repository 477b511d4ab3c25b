#include "libcommon/base/output_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

std::string reason(const char* what) {
  return std::string(what) + ": " + std::strerror(errno);
}

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return true;
}

void write_directly(const std::string& path, std::string_view bytes) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) throw OutputError(path, reason("cannot be opened for writing"));
  const bool ok = write_all(fd, bytes);
  const std::string why = ok ? "" : reason("cannot be written");
  ::close(fd);
  if (!ok) throw OutputError(path, why);
}

}  // namespace

void write_output(const std::string& path, std::string_view bytes) {
  if (path == "-") {
    if (!write_all(STDOUT_FILENO, bytes))
      throw OutputError("(standard output)", reason("cannot be written"));
    return;
  }
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) throw OutputError(path, "is a folder, expected a file name");
  if (exists && !S_ISREG(info.st_mode)) return write_directly(path, bytes);

  std::string temporary = path + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) throw OutputError(path, reason("cannot be created"));
  const mode_t mask = ::umask(0);
  ::umask(mask);
  std::string why;
  if (!write_all(fd, bytes) || ::fsync(fd) != 0) why = reason("cannot be written");
  if (why.empty() && ::fchmod(fd, exists ? info.st_mode & 0777 : 0666 & ~mask) != 0)
    why = reason("cannot set permissions");
  ::close(fd);
  if (why.empty() && ::rename(temporary.c_str(), path.c_str()) != 0)
    why = reason("cannot be renamed into place");
  if (!why.empty()) {
    ::unlink(temporary.c_str());
    throw OutputError(path, why);
  }
}

void check_output(const std::string& path) {
  if (path == "-") return;
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) throw OutputError(path, "is a folder, expected a file name");
    if (::access(path.c_str(), W_OK) != 0)
      throw OutputError(path, reason("cannot be opened for writing"));
    if (!S_ISREG(info.st_mode)) return;
  }
  const size_t slash = path.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw OutputError(path, reason("cannot be created"));
}

}  // namespace tdpt
