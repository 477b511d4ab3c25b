#include "libcommon/base/output_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>

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

// Creates a temporary file in the folder of `path`; its name does not grow with that of `path`.
int make_temporary(const std::string& path, std::string& name) {
  name = path.substr(0, path.find_last_of('/') + 1) + ".tdpt-XXXXXX";
  return ::mkostemp(name.data(), O_CLOEXEC);
}

// What a symbolic link points to is replaced, not the link.
std::string follow_link(const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0 || !S_ISLNK(info.st_mode)) return path;
  const std::unique_ptr<char, void (*)(void*)> target(::realpath(path.c_str(), nullptr), std::free);
  return target ? target.get() : path;
}

// A file that nobody may write is meant to stay, even where the super-user could replace it.
void refuse_read_only(const std::string& path, const struct stat& info) {
  if ((info.st_mode & 0222) == 0)
    throw OutputError(path, "is a read-only file, which is not replaced");
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

void write_output(const std::string& given, std::string_view bytes) {
  if (given == "-") {
    if (!write_all(STDOUT_FILENO, bytes))
      throw OutputError("(standard output)", reason("cannot be written"));
    return;
  }
  const std::string path = follow_link(given);
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) throw OutputError(path, "is a folder, expected a file name");
  if (exists && !S_ISREG(info.st_mode)) return write_directly(path, bytes);
  if (exists) refuse_read_only(path, info);

  std::string temporary;
  const int fd = make_temporary(path, temporary);
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

void check_output(const std::string& given) {
  if (given == "-") return;
  if (given.empty()) throw UsageError("an output file has an empty name");
  const std::string path = follow_link(given);
  struct stat info {};
  if (::stat(path.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) throw OutputError(path, "is a folder, expected a file name");
    if (::access(path.c_str(), W_OK) != 0)
      throw OutputError(path, reason("cannot be opened for writing"));
    if (!S_ISREG(info.st_mode)) return;
    refuse_read_only(path, info);
  }
  // A name that is too long or otherwise impossible says so here and not after the work.
  if (::access(path.c_str(), F_OK) != 0 && errno != ENOENT)
    throw OutputError(path, reason("cannot be created"));
  std::string temporary;
  const int fd = make_temporary(path, temporary);
  if (fd < 0) throw OutputError(path, reason("cannot be created"));
  ::close(fd);
  ::unlink(temporary.c_str());
}

}  // namespace tdpt
