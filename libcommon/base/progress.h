// Progress of long work: one line on stderr with rate and time left, only when stderr is a
// terminal.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace tdpt {

/// Thread-safe: any thread may call advance().
class Progress {
 public:
  /// `what` names the work ("rendering"), `unit` what is counted ("samples"), `total` how many
  /// are expected (0: unknown). Shows nothing when `quiet` or when stderr is no terminal.
  Progress(std::string what, std::string unit, uint64_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(uint64_t n = 1);
  /// What else the line says, at its end; while no thread advances.
  void tell(std::string more) { more_ = std::move(more); }

 private:
  void show(double seconds, uint64_t done);

  using Clock = std::chrono::steady_clock;
  std::string what_, unit_, more_;
  uint64_t total_;
  bool visible_;
  std::atomic<uint64_t> done_{0};
  std::atomic<int64_t> next_ms_{300};
  Clock::time_point start_ = Clock::now();
};

}  // namespace tdpt
