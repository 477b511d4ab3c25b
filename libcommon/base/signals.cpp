#include "libcommon/base/signals.h"

#include <csignal>
#include <cstdint>
#include <initializer_list>

#include <time.h>

namespace tdpt {
namespace {
volatile std::sig_atomic_t stopped = 0;
volatile int64_t stopped_at = 0;  // [ms]

int64_t milliseconds() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{now.tv_sec} * 1000 + now.tv_nsec / 1000000;
}

void on_signal(int number) {
  if (!stopped) {
    stopped_at = milliseconds();
    stopped = 1;
  } else if (milliseconds() - stopped_at > 1000) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}
}  // namespace

void catch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, on_signal) == SIG_IGN) std::signal(number, SIG_IGN);
}

bool stop_requested() {
  return stopped != 0;
}

}  // namespace tdpt
