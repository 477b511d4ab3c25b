#include "libcommon/base/signals.h"

#include <csignal>

namespace tdpt {
namespace {
volatile std::sig_atomic_t stopped = 0;
void on_signal(int number) {
  if (stopped) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
  stopped = 1;
}
}  // namespace

void catch_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool stop_requested() {
  return stopped != 0;
}

}  // namespace tdpt
