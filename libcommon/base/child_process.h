// Another program, started without a shell, that never outlives this one.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace tdpt {

/// Runs from its construction on, with standard input empty; what it writes on stderr is read here.
/// However this process ends, by SIGKILL too, the child is killed: the kernel ties it to the thread
/// that starts it, so only the main thread may.
class ChildProcess {
 public:
  struct How {
    bool shares_stdout = false;  ///< with this process; otherwise what it prints there is lost
    std::string stdout_file;     ///< receives what it prints; empty: as above
    int niceness = 0;            ///< added to that of this process [nice(2)]
  };

  /// `words`: path of the program, or its name where PATH leads to it, and its arguments. Throws
  /// Error(Exit::internal) where the system gives no process, and where another thread than the
  /// main one calls.
  ChildProcess(const std::vector<std::string>& words, const How& how);
  /// Kills it where it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// To wait for what read() gets; negative when that has ended.
  int descriptor() const { return errors_; }
  /// Appends what it has written on stderr since, without waiting. False where no more will come.
  bool read(std::string& text);
  void send(int signal) const;
  /// Its exit code, once it has ended; that of a shell, 128 and more, where a signal ended it.
  std::optional<int> exit_code();

 private:
  pid_t pid_ = -1;
  int errors_ = -1;
  std::optional<int> code_;
};

/// Ends the calling process when its parent, the process `parent`, does. For use between fork() and
/// exec(), or in a copy that does some work for its parent.
void die_with_parent(pid_t parent);

/// Folder of the running program.
std::string program_folder();

}  // namespace tdpt
