#include "libcommon/base/output_file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

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

// Creates a temporary file in the folder of `path`; the length of its name does not depend on
// `path`.
int make_temporary(const std::string& path, std::string& name) {
  name = path.substr(0, path.find_last_of('/') + 1) + ".tdpt-XXXXXX";
  return ::mkostemp(name.data(), O_CLOEXEC);
}

std::string folder_of(const std::string& path) {
  const size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

// An unnamed file (O_TMPFILE) in the folder of `path`, which vanishes with its process however that
// ends; negative if the file system does not support it or it could not be named later.
int make_nameless(const std::string& path) {
  if (::access("/proc/self/fd", X_OK) != 0) return -1;
  return ::open(folder_of(path).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
}

// Gives it a unique temporary name in that folder.
bool name_temporarily(int fd, const std::string& path, std::string& name) {
  const std::string from = "/proc/self/fd/" + std::to_string(fd);
  for (unsigned i = 0; i < 1000; ++i) {
    name = path.substr(0, path.find_last_of('/') + 1) + ".tdpt-" + std::to_string(::getpid()) +
           "-" + std::to_string(i);
    if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
      return true;
    if (errno != EEXIST) break;
  }
  name.clear();
  return false;
}

// Makes renames in the folder survive a power failure. Not every file system supports it.
void sync_folder(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  (void)::fsync(fd);
  ::close(fd);
}

// A symbolic link is kept: the file that it points to is replaced.
std::string follow_link(const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0 || !S_ISLNK(info.st_mode)) return path;
  const std::unique_ptr<char, void (*)(void*)> target(::realpath(path.c_str(), nullptr), std::free);
  return target ? target.get() : path;
}

// A read-only file is meant to stay, even where the super-user could replace it.
void refuse_read_only(const std::string& path, const struct stat& info) {
  if ((info.st_mode & 0222) == 0)
    throw OutputError(path, "is a read-only file, which is not replaced");
}

// Not a regular file, so not replaceable by one: standard output, a device, a pipe.
bool is_stream(const std::string& path) {
  struct stat info {};
  return path == "-" ||
         (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode));
}

void write_stream(const std::string& path, std::string_view bytes) {
  if (path == "-") {
    if (!write_all(STDOUT_FILENO, bytes))
      throw OutputError("(standard output)", reason("cannot be written"));
    return;
  }
  const int fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (fd < 0) throw OutputError(path, reason("cannot be opened for writing"));
  const bool ok = write_all(fd, bytes);
  const std::string why = ok ? "" : reason("cannot be written");
  ::close(fd);
  if (!ok) throw OutputError(path, why);
}

// A file on disk without a name, or under a temporary one; removed unless it gets its final name.
class Staged {
 public:
  Staged(const std::string& given, std::string_view bytes) : path_(follow_link(given)) {
    struct stat info {};
    const bool exists = ::stat(path_.c_str(), &info) == 0;
    if (exists && S_ISDIR(info.st_mode))
      throw OutputError(path_, "is a folder, expected a file name");
    if (exists) refuse_read_only(path_, info);
    fd_ = make_nameless(path_);
    if (fd_ < 0) fd_ = make_temporary(path_, temporary_);
    if (fd_ < 0) {
      temporary_.clear();
      throw OutputError(path_, reason("cannot be created"));
    }
    const mode_t mask = ::umask(0);
    ::umask(mask);
    std::string why;
    if (!write_all(fd_, bytes) || ::fsync(fd_) != 0) why = reason("cannot be written");
    if (why.empty() && ::fchmod(fd_, exists ? info.st_mode & 0777 : 0666 & ~mask) != 0)
      why = reason("cannot set permissions");
    if (why.empty()) return;
    remove();  // a constructor that throws does not run the destructor
    throw OutputError(path_, why);
  }
  Staged(Staged&& other) noexcept
      : path_(std::move(other.path_)),
        temporary_(std::exchange(other.temporary_, {})),
        fd_(std::exchange(other.fd_, -1)) {}
  ~Staged() { remove(); }

  void name() {
    const bool named = !temporary_.empty() || name_temporarily(fd_, path_, temporary_);
    if (!named || ::rename(temporary_.c_str(), path_.c_str()) != 0)
      throw OutputError(path_, reason("cannot be renamed into place"));
    temporary_.clear();
    sync_folder(folder_of(path_));
  }

 private:
  void remove() {
    if (fd_ >= 0) ::close(fd_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    fd_ = -1;
  }

  std::string path_, temporary_;
  int fd_ = -1;
};

// The files in order; the caller owns the bytes.
using Bytes = std::pair<std::string, std::string_view>;
void write_together(const std::vector<Bytes>& files) {
  std::vector<Staged> staged;
  for (const auto& [path, bytes] : files)
    if (!is_stream(path)) staged.emplace_back(path, bytes);
  for (const auto& [path, bytes] : files)
    if (is_stream(path)) write_stream(path, bytes);
  for (auto file = staged.rbegin(); file != staged.rend(); ++file) file->name();
}

}  // namespace

void write_output(const std::string& path, std::string_view bytes) {
  write_together({{path, bytes}});
}

void write_outputs(const std::vector<OutputFile>& files) {
  std::vector<Bytes> all;
  for (const OutputFile& file : files) all.emplace_back(file.path, file.bytes);
  write_together(all);
}

std::string keep_elsewhere(const std::string& name, std::string_view bytes) {
  const std::string file = name.substr(name.find_last_of('/') + 1);
  const size_t dot = std::min(file.find_last_of('.'), file.size());
  for (const char* variable : {"TMPDIR", "", "HOME"}) {
    const char* folder = *variable ? std::getenv(variable) : "/tmp";
    if (!folder || !*folder) continue;
    std::string path =
        std::string(folder) + "/" + file.substr(0, dot) + "-XXXXXX" + file.substr(dot);
    const int fd = ::mkostemps(path.data(), static_cast<int>(file.size() - dot), O_CLOEXEC);
    if (fd < 0) continue;
    const bool ok = write_all(fd, bytes) && ::fsync(fd) == 0;
    ::close(fd);
    if (ok) return path;
    ::unlink(path.c_str());
  }
  return "";
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
  // Reports a name that is too long or otherwise impossible now instead of after the work.
  if (::access(path.c_str(), F_OK) != 0 && errno != ENOENT)
    throw OutputError(path, reason("cannot be created"));
  std::string temporary;
  const int fd = make_temporary(path, temporary);
  if (fd < 0) throw OutputError(path, reason("cannot be created"));
  ::close(fd);
  ::unlink(temporary.c_str());
}

}  // namespace tdpt
