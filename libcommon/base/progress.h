// Progress of long work on stderr, with rate and time left: a line that is rewritten in place on a
// terminal, or JSON lines for a program that watches.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace tdpt {

/// automatic: the line, if stderr is a terminal and --quiet is not given; json: JSON, quiet or not.
enum class ProgressForm { automatic, json, none };

/// Applies to every bar made afterwards. Call once, before any parallel work; automatic if
/// never called.
void show_progress_as(ProgressForm form);
/// That form; none in the place of automatic where no line is shown.
ProgressForm progress_form(bool quiet);

/// Thread-safe: any thread may call advance().
class ProgressBar {
 public:
  /// `what` names the work ("rendering"), `unit` what is counted ("samples"), `total` how many
  /// are expected (0: unknown).
  ProgressBar(std::string what, std::string unit, uint64_t total, bool quiet);
  /// Erases the line; as JSON reports how the work ended.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For an unknown `total`: the work is to end this many seconds after it began. Call before the
  /// first advance().
  void ends_after(double seconds) { lasts_ = seconds; }
  /// Shows the progress if 0.3 s have passed since it was last shown.
  void advance(uint64_t n = 1);
  /// Text shown after the rest. Call while no thread advances.
  void tell(std::string more) { more_ = std::move(more); }

 private:
  struct Figures {
    uint64_t done;
    double seconds, rate;  ///< rate [1/s]
    double left;           ///< [s]; negative: unknown
    double share;          ///< done, [0,1], where `left` is known
  };
  double seconds() const;
  Figures figures() const;
  std::string line(const Figures& f) const;
  std::string json(const Figures& f) const;
  void show();

  using Clock = std::chrono::steady_clock;
  std::string what_, unit_, more_;
  uint64_t total_;
  double lasts_ = 0;   ///< [s]; 0: unknown
  ProgressForm form_;  ///< automatic: the line
  std::atomic<uint64_t> done_{0};
  std::atomic<int64_t> next_ms_{300};
  std::mutex showing_;  ///< so that no line shows less than the one before it
  Clock::time_point start_ = Clock::now();
};

/// A message for people on stderr. A failed write (full disk, terminal gone) is ignored, so that it
/// ends no work; fmt::print would throw.
void say(const std::string& line);

}  // namespace tdpt
