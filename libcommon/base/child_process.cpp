#include "libcommon/base/child_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt {

namespace {

// Ends the calling process when its parent, the process `parent`, ends. For use between fork() and
// exec(), or in a forked copy that works for its parent.
void die_with_parent(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(static_cast<int>(Exit::internal));  // already ended
}

[[noreturn]] void fail(const std::string& what, int error) {
  throw Error(Exit::internal, what + ": " + std::strerror(error));
}

// Runs in the child: from here on only functions that are safe after fork().
[[noreturn]] void become(char** argv, const ChildProcess::How& how, pid_t parent, int errors) {
  die_with_parent(parent);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, 0);
  if (!how.stdout_file.empty()) {
    const int file = ::open(how.stdout_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    ::dup2(file < 0 ? nothing : file, 1);
  } else if (!how.shares_stdout) {
    ::dup2(nothing, 1);
  }
  ::dup2(errors, 2);
  if (how.niceness != 0 && ::nice(how.niceness) < 0) errno = 0;  // then it only runs faster
  ::execvp(argv[0], argv);
  const char* const why = std::strerror(errno);
  for (const char* part : {static_cast<const char*>(argv[0]), ": cannot be started: ", why, "\n"})
    if (::write(2, part, std::strlen(part)) < 0) break;
  ::_exit(static_cast<int>(Exit::internal));
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words, const How& how) {
  const pid_t self = ::getpid();
  if (::syscall(SYS_gettid) != self)
    throw Error(Exit::internal, "a program is started by a thread that may end before it");
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(words[0] + ": cannot be started", errno);
  pid_ = ::fork();
  const int error_of_fork = errno;
  if (pid_ == 0) become(argv.data(), how, self, ends[1]);
  ::close(ends[1]);
  errors_ = ends[0];
  if (pid_ < 0) {
    ::close(errors_);
    fail(words[0] + ": cannot be started", error_of_fork);
  }
  ::fcntl(errors_, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  if (!code_) {
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
  }
  if (errors_ >= 0) ::close(errors_);
}

bool ChildProcess::read(std::string& text) {
  char part[4096];
  while (errors_ >= 0) {
    const ssize_t n = ::read(errors_, part, sizeof part);
    if (n > 0) {
      text.append(part, static_cast<size_t>(n));
    } else if (n < 0 && errno == EINTR) {
      continue;
    } else if (n < 0 && errno == EAGAIN) {
      return true;
    } else {
      ::close(errors_);
      errors_ = -1;
    }
  }
  return false;
}

void ChildProcess::send(int signal) const {
  if (!code_) ::kill(pid_, signal);
}

std::optional<int> ChildProcess::exit_code() {
  int status = 0;
  if (!code_ && ::waitpid(pid_, &status, WNOHANG) == pid_)
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return code_;
}

std::string program_folder() {
  std::error_code failed;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed)
    throw Error(Exit::internal, "the folder of the programs cannot be told without /proc");
  return self.parent_path().string();
}

// Forks; the copy writes its result into a pipe, and the result counts only if the copy exits
// normally.

namespace {

constexpr const char* kNoOther = "no other process can be started";

// From now on operator new fails once the process holds this many bytes more than now, plus some
// room for the libraries. Unlimited if the system does not report the memory held.
void limit_what_is_held(uint64_t bytes) {
  constexpr rlim_t for_libraries = rlim_t{16} << 20;
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (!file) return;
  unsigned long pages = 0;
  const bool known = std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) == 1;
  std::fclose(file);
  const rlim_t held = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  const rlimit most{held + for_libraries + bytes, RLIM_INFINITY};
  if (known) ::setrlimit(RLIMIT_DATA, &most);
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
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(kNoOther, errno);
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
    fail(kNoOther, error_of_fork);
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

}  // namespace tdpt
