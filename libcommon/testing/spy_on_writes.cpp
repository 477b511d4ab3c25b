// LD_PRELOAD library that logs, one per line into the file SPY_ON_WRITES, the order in which a
// program writes, flushes and renames files. With SPOIL_RENAME a rename becomes a slow copy, as
// careless programs do it: a planted fault.
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

template <class F>
F* real(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

void tell(const char* what, const char* of) {
  const char* path = std::getenv("SPY_ON_WRITES");
  if (!path) return;
  char line[512];
  const int n = std::snprintf(line, sizeof line, "%s %s\n", what, of);
  const int fd = ::open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0 || n < 0) return;
  static auto* const write_really = real<ssize_t(int, const void*, size_t)>("write");
  (void)!write_really(fd, line, static_cast<size_t>(n));
  ::close(fd);
}

const char* kind_of(int fd) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return "nothing";
  return S_ISDIR(info.st_mode) ? "folder" : S_ISREG(info.st_mode) ? "file" : "stream";
}

int copy_slowly(const char* from, const char* to) {
  static auto* const write_really = real<ssize_t(int, const void*, size_t)>("write");
  const int in = ::open(from, O_RDONLY | O_CLOEXEC);
  const int out = ::open(to, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  char block[4096];
  for (ssize_t n; (n = ::read(in, block, sizeof block)) > 0;) {
    (void)!write_really(out, block, static_cast<size_t>(n));
    ::usleep(2000);
  }
  ::close(in);
  ::close(out);
  return ::unlink(from);
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* bytes, size_t n) {
  static auto* const really = real<ssize_t(int, const void*, size_t)>("write");
  const char* kind = kind_of(fd);
  if (std::strcmp(kind, "file") == 0) tell("write", kind);
  return really(fd, bytes, n);
}

int fsync(int fd) {
  static auto* const really = real<int(int)>("fsync");
  tell("fsync", kind_of(fd));
  return really(fd);
}

int rename(const char* from, const char* to) {
  static auto* const really = real<int(const char*, const char*)>("rename");
  tell("rename", to);
  return std::getenv("SPOIL_RENAME") ? copy_slowly(from, to) : really(from, to);
}
}
