// Makes what a request asks for: portals if there are none yet, the picture, its report. Results
// that exist and are up to date are kept.
#pragma once
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "libcommon/base/child_process.h"
#include "tools/tdpt/conversation.h"
#include "tools/tdpt/pipeline.h"

namespace tdpt {

class Making {
 public:
  /// Throws Error for what is wrong before a program runs, as do run() and print().
  Making(const Arguments& a, const cli::Common& common, ProgressForm form);
  ~Making();
  Making(const Making&) = delete;
  Making& operator=(const Making&) = delete;

  /// Returns the exit code.
  int run();
  /// Prints the commands that run() would execute, for a shell. `printed`: entries of the work
  /// folder whose commands were printed before; it is added to.
  void print(std::set<std::string>& printed);

 private:
  /// A file that a command makes, and the key of its bytes; no path: it is not asked for.
  struct Result {
    std::string path, key;
  };
  /// Whether a message is of this picture, or of those of all cameras.
  enum class Of { picture, all };

  Result picture() const { return {request_.picture, pipeline_.key}; }
  Result preview() const;
  Result report() const;
  std::vector<Result> files_beside() const;
  bool is_there(const Result& result) const;
  bool is_fresh() const;
  void know(const Result& result) const;
  void check_owners() const;

  void make();
  void find_portals();
  void run_stage(const Search& search, const Step& step);
  void render();
  void place(bool whole);
  void render_frames();
  void filter_frames();
  std::vector<FilteredFrame> missing_frames() const;
  void make_report();
  void make_preview() const;
  void publish(const std::string& preview);

  void begin_step(const std::string& title, const std::string& program, Of of = Of::picture);
  /// Returns the exit code. `told` receives its messages; decisions go only there.
  int run_program(const Words& words, const ChildProcess::How& how = {},
                  std::string* told = nullptr);
  /// Throws the exit code if it is not 0.
  void need(const Words& words, const ChildProcess::How& how = {});
  bool has_changed() const;

  const Arguments& a_;
  const cli::Common& common_;
  const Request request_;
  const WorkFolder work_;
  const std::string programs_;
  const SceneState state_;
  const Pipeline pipeline_;
  const std::string run_;  ///< folder of files that go when this run ends
  Conversation conversation_;
  std::unique_ptr<ChildProcess> look_;  ///< renders a first preview while portals are sought
  std::string doing_, left_;  ///< what runs, and what there is of the picture, for a signal
  std::filesystem::file_time_type preview_time_{};  ///< of the last published preview
  size_t step_ = 0, steps_ = 0;
};

}  // namespace tdpt
