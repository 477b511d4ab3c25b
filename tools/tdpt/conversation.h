// The output of tdpt while its programs run: one progress line for all of them, or JSON, and their
// messages as they come.
#pragma once
#include <chrono>
#include <set>
#include <string>

#include "libcommon/base/progress.h"

namespace tdpt {

class Conversation {
 public:
  /// `quiet`: no progress on a terminal.
  explicit Conversation(bool quiet);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// From now on step `number` of `steps` runs, counted from 1. `about`: the one of several
  /// pictures that it is of, named in each message; else empty.
  void step(size_t number, size_t steps, const std::string& title, const std::string& program,
            const std::string& about);
  /// Handles a line from the program: its progress, or a message, which is printed unless another
  /// program that reads the same files has said it.
  void print(const std::string& line);
  /// Shows the elapsed time if nothing else is reported; call now and then.
  void tick();

 private:
  using Clock = std::chrono::steady_clock;
  void show(const std::string& how_far);
  void clear();

  ProgressForm form_;
  std::string title_, program_, about_;
  size_t number_ = 0, steps_ = 0;
  Clock::time_point began_ = Clock::now(), shown_ = began_;
  std::string reported_;        ///< progress last reported by the program
  std::set<std::string> said_;  ///< messages, without the names of programs
  bool visible_ = false;
};

}  // namespace tdpt
