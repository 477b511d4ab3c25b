// Another program, started without a shell, that never outlives this one.
#pragma once
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

/// Ends the calling process when its parent, the process `parent`, ends. For use between fork() and
/// exec(), or in a forked copy that works for its parent.
void die_with_parent(pid_t parent);

/// Folder of the running program.
std::string program_folder();

}  // namespace tdpt
