#include "libcommon/base/child_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

[[noreturn]] void fail(const std::string& program, int error) {
  throw Error(Exit::internal, program + ": cannot be started: " + std::strerror(error));
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
  if (::pipe2(ends, O_CLOEXEC) != 0) fail(words[0], errno);
  pid_ = ::fork();
  const int error_of_fork = errno;
  if (pid_ == 0) become(argv.data(), how, self, ends[1]);
  ::close(ends[1]);
  errors_ = ends[0];
  if (pid_ < 0) {
    ::close(errors_);
    fail(words[0], error_of_fork);
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

void die_with_parent(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(static_cast<int>(Exit::internal));  // already ended
}

std::string program_folder() {
  std::error_code failed;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed)
    throw Error(Exit::internal, "the folder of the programs cannot be told without /proc");
  return self.parent_path().string();
}

}  // namespace tdpt
