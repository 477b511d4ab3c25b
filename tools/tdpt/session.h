// A run of tdpt: its folder, the programs that it starts one after the other, and what it prints
// while they work: one progress line for all of them, or JSON, and their messages as they come.
#pragma once
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "libcommon/base/child_process.h"
#include "libcommon/base/progress.h"
#include "tools/tdpt/request.h"

namespace tdpt {

/// A program that failed or was stopped.
struct ProgramEnded {
  int code;  ///< its exit code
};

class Session {
 public:
  /// `folder`: of files that go when this run ends. `in_use`: one of the cache that is kept young,
  /// too. `preview`: where renderings show themselves; empty: nowhere. `quiet`: no progress on a
  /// terminal.
  Session(std::string folder, std::string in_use, std::string preview, size_t steps, bool quiet);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  std::string path_of(const std::string& name) const { return folder_ + "/" + name; }
  const std::string& title() const { return title_; }  ///< of the step

  /// The next step begins. `about`: the one of several pictures that it is of, named in each
  /// message; else empty.
  void begin_step(const std::string& title, const std::string& program, const std::string& about);
  /// Runs a program of that step and returns its exit code. Its messages are printed unless another
  /// program that reads the same files has printed them; `explained` receives all of them and, in
  /// place of the terminal, the decisions of --explain.
  int run(const Words& words, const ChildProcess::How& how = {}, std::string* explained = nullptr);
  /// The same; throws ProgramEnded unless the program succeeds.
  void need(const Words& words, const ChildProcess::How& how = {},
            std::string* explained = nullptr);

  /// Starts a renderer of a first preview, which runs beside the programs until
  /// end_first_preview().
  void begin_first_preview(Words words);
  void end_first_preview() { first_preview_.reset(); }
  bool has_first_preview() const { return first_preview_ != nullptr; }
  /// Copies the preview that a renderer has written into the run's folder, if it has changed.
  void publish_preview();

 private:
  using Clock = std::chrono::steady_clock;
  void print(const std::string& line);
  void show(const std::string& how_far);
  void clear();

  const std::string folder_, in_use_, preview_;
  ProgressForm form_;
  std::string title_, program_, about_;
  size_t step_ = 0, steps_;
  Clock::time_point began_ = Clock::now(), shown_ = began_;
  std::string progress_;           ///< last reported by the program
  std::set<std::string> printed_;  ///< messages, without the names of programs
  bool line_visible_ = false;
  std::unique_ptr<ChildProcess> first_preview_;
  std::filesystem::file_time_type preview_time_{};  ///< of the last published preview
};

}  // namespace tdpt
