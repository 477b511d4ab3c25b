// Makes what a request asks for: portals if there are none yet, the picture, its report. Results
// that exist and are up to date are kept.
#pragma once
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "tools/tdpt/conversation.h"
#include "tools/tdpt/first_look.h"
#include "tools/tdpt/made.h"

namespace tdpt {

class Making {
 public:
  Making(const Arguments& a, const cli::Common& common, ProgressForm form);

  /// Returns the exit code. Throws Error for what is wrong before a program runs.
  int run();
  /// Prints the commands that run() would execute, for a shell. `printed`: entries of the work
  /// folder whose commands were printed before; it is added to.
  int print(std::set<std::string>& printed);

 private:
  /// How a program ended; `changed`: the scene changed meanwhile, so that its results are invalid.
  struct Ending {
    int code = 0;
    bool changed = false;
    bool good() const { return code == 0 && !changed; }
  };
  /// Whether a program reads the scene.
  enum class Reads { scene, files };
  /// Whether what it tells is of this picture, or of those of all cameras.
  enum class Of { picture, all };

  bool all_is_fresh() const;
  bool report_is_fresh() const;
  std::function<void()> waits(const std::string& sentence) const;
  void hold_picture();
  void check_owners() const;
  Ending attempt();
  Ending check();
  Ending find_portals();
  Ending find_portals(const Search& search);
  Ending run_stages(const Search& search);
  Ending render();
  Ending render_frames();
  Ending filter_frames();
  std::vector<FilteredFrame> missing_frames() const;
  Ending make_report();
  Ending make_shot_report();
  /// `told` receives the program's messages; decisions go only there.
  Ending run_program(const Words& words, const ChildProcess::How& how, Reads reads,
                     Of of = Of::picture, std::string* told = nullptr);
  std::string title_of_picture(const std::string& title) const;
  Ending ending_of(const std::string& program, int code) const;
  void begin_step(const std::string& title, const Words& words);
  void place(bool whole);
  void publish_preview();
  void mend_preview();
  bool has_changed() const;
  void settle();
  void tell_end(int code) const;
  std::vector<std::string> what_stays() const;

  const Arguments& a_;
  const cli::Common& common_;
  Request request_;
  WorkFolder work_;
  std::string programs_;
  Conversation conversation_;
  SceneState state_;
  Pipeline pipeline_;
  HeldEntry picture_, portals_;
  std::unique_ptr<FirstLook> look_;
  std::string doing_, left_;  ///< what runs, and what there is of the picture, for a signal
  std::string before_;        ///< hash of the picture that may be replaced; "": there is none
  std::filesystem::file_time_type preview_time_{};  ///< of the last published preview
  size_t step_ = 0, steps_ = 0;
};

}  // namespace tdpt
