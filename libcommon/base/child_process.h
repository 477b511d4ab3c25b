// Other processes, none of which outlives this one: programs started without a shell, and work in a
// copy of this process.
#pragma once
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace tdpt {

/// Runs from construction on, with empty standard input; its stderr is read here. However this
/// process ends, even by SIGKILL, the child is killed: the kernel ties it to the thread that starts
/// it, so only the main thread may start one.
class ChildProcess {
 public:
  struct How {
    bool shares_stdout = false;  ///< its stdout is that of this process; otherwise it is discarded
    std::string stdout_file;     ///< receives its stdout; empty: as above
    int niceness = 0;            ///< added to that of this process [nice(2)]
  };

  /// `words`: the program (a path, or a name found in PATH) and its arguments. Throws
  /// Error(Exit::internal) if no process can be created, or if called from another thread than the
  /// main one.
  ChildProcess(const std::vector<std::string>& words, const How& how);
  /// Kills it if it is still running.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// To poll for what read() would get; negative once the stream has ended.
  int descriptor() const { return errors_; }
  /// Appends what it has written to stderr since the last call, without blocking. False at the end
  /// of the stream.
  bool read(std::string& text);
  void send(int signal) const;
  /// Its exit code once it has ended; 128 + the signal's number, as in a shell, if a signal ended
  /// it.
  std::optional<int> exit_code();

 private:
  pid_t pid_ = -1;
  int errors_ = -1;
  std::optional<int> code_;
};

/// Folder of the running program.
std::string program_folder();

// Runs work in a child process, for libraries that may abort the program on bad input.

/// Runs `work` in a forked copy of this process, while `take` reads here what it writes. The copy
/// prints nothing on stderr, dumps no core and may allocate about memory_limit() more than this
/// process. Returns true if the copy ended normally (no exception, signal or exit of its own) and
/// `take` returned true. The copy has a single thread, so `work` must not wait for another. Throws
/// Error(Exit::internal) if no process can be created.
bool in_another_process(const std::function<void(std::FILE* out)>& work,
                        const std::function<bool(std::FILE* in)>& take);

}  // namespace tdpt
