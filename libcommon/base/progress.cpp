#include "libcommon/base/progress.h"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace tdpt {

Progress::Progress(std::string what, std::string unit, uint64_t total, bool quiet)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      visible_(!quiet && ::isatty(STDERR_FILENO)) {}

Progress::~Progress() {
  if (visible_ && next_ms_ > 300) std::fputs("\r\033[K", stderr);
}

void Progress::advance(uint64_t n) {
  const uint64_t done = done_.fetch_add(n) + n;
  if (!visible_) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  int64_t due = next_ms_.load();
  const auto now_ms = static_cast<int64_t>(seconds * 1000);
  if (now_ms >= due && next_ms_.compare_exchange_strong(due, now_ms + 300)) show(seconds, done);
}

void Progress::show(double seconds, uint64_t done) {
  const double rate = static_cast<double>(done) / seconds;
  std::string line = fmt::format("\r\033[K{}: {} {}, {:.3g}/s", what_, done, unit_, rate);
  if (total_ > 0 && done > 0) {
    const double left = static_cast<double>(total_ - std::min(done, total_)) / rate;
    line += fmt::format(", {:.0f} %, {:.0f} s left",
                        100.0 * static_cast<double>(done) / static_cast<double>(total_), left);
  }
  if (!more_.empty()) line += ", " + more_;
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace tdpt
