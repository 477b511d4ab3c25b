// What tdpt says while its programs run: one line of progress over all of them, or JSON, and what
// they have to say, as they say it.
#pragma once
#include <chrono>
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

  /// From now on the step `number` of `steps` runs, from 1.
  void step(size_t number, size_t steps, const std::string& title, const std::string& program);
  /// A line that the program has written. Whether it told of progress.
  bool heard(const std::string& line);
  /// Shows how long it has been, where nothing else is told; call now and then.
  void tick();
  /// A line of one's own, on stderr.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  void show(const std::string& how_far);
  void clear();

  ProgressForm form_;
  std::string title_, program_;
  size_t number_ = 0, steps_ = 0;
  Clock::time_point began_ = Clock::now(), shown_ = began_;
  std::string told_;  ///< by the program, how far it is
  bool visible_ = false;
};

}  // namespace tdpt
