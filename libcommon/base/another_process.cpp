// Forks; the copy writes its result into a pipe, and the result counts only if the copy exits
// normally.
#include "libcommon/base/another_process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <string>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"

namespace tdpt {
namespace {

[[noreturn]] void fail(int error) {
  throw Error(Exit::internal,
              std::string("no other process can be started: ") + std::strerror(error));
}

// From now on operator new fails once the process holds this many bytes more than now, plus some
// room for the libraries. Unlimited if the system does not report the memory held.
void limit_what_is_held(uint64_t bytes) {
  constexpr rlim_t for_libraries = rlim_t{16} << 20;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (!file) return;
  unsigned long pages = 0;
  const bool told = std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) == 1;
  std::fclose(file);
  const rlim_t held = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  const rlimit most{held + for_libraries + bytes, RLIM_INFINITY};
  if (told) ::setrlimit(RLIMIT_DATA, &most);
}

// Never returns. _exit() flushes nothing, so the parent's buffered output is not written twice.
[[noreturn]] void run(const std::function<void(std::FILE*)>& work, int end, pid_t parent) {
  die_with_parent(parent);
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, 2);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  limit_what_is_held(memory_limit());
  for (const int signal : {SIGABRT, SIGPIPE}) std::signal(signal, SIG_DFL);
  bool done = false;
  try {
    std::FILE* const out = ::fdopen(end, "wb");
    if (out) work(out), done = std::fflush(out) == 0;
  } catch (...) {  // reported by the exit code
  }
  ::_exit(done ? 0 : 1);
}

}  // namespace

bool in_another_process(const std::function<void(std::FILE*)>& work,
                        const std::function<bool(std::FILE*)>& take) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(errno);
  const pid_t self = ::getpid();
  const pid_t child = ::fork();
  const int error_of_fork = errno;
  if (child == 0) {
    ::close(ends[0]);
    run(work, ends[1], self);
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    fail(error_of_fork);
  }
  std::FILE* const in = ::fdopen(ends[0], "rb");
  bool taken = false;
  std::exception_ptr error;  // rethrown after the copy has been waited for
  try {
    taken = in && take(in);
  } catch (...) {
    error = std::current_exception();
  }
  if (in)
    std::fclose(in);
  else
    ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (error) std::rethrow_exception(error);
  return taken && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void limit_this_process(uint64_t bytes, unsigned seconds) {
  limit_what_is_held(std::min(bytes, memory_limit()));
  const rlimit time{seconds, RLIM_INFINITY};
  ::setrlimit(RLIMIT_CPU, &time);
}

}  // namespace tdpt
