// The output of tdpt while its programs run: one progress line for all of them, or JSON, and their
// messages as they come.
#pragma once
#include <chrono>
#include <map>
#include <string>

#include "libcommon/base/progress.h"

namespace tdpt {

class Conversation {
 public:
  /// `quiet`: no progress on a terminal.
  Conversation(ProgressForm form, bool quiet);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// From now on step `number` of `steps` runs, counted from 1.
  void step(size_t number, size_t steps, const std::string& title, const std::string& program);
  /// Handles a line from the program. Returns whether it reported progress.
  bool heard(const std::string& line);
  /// Shows the elapsed time if nothing else is reported; call now and then.
  void tick();
  /// Prints a line of tdpt itself on stderr.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void show(const std::string& how_far);
  void clear();

  ProgressForm form_;
  std::string title_, program_;
  size_t number_ = 0, steps_ = 0;
  Clock::time_point began_ = Clock::now(), shown_ = began_;
  std::string told_;                            ///< progress last reported by the program
  std::map<std::string, std::string> reasons_;  ///< why there is no bottleneck, by whom
  bool visible_ = false;
};

}  // namespace tdpt
