#include "libcommon/base/signals.h"

#include <csignal>
#include <initializer_list>

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
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, on_signal) == SIG_IGN) std::signal(number, SIG_IGN);
}

bool stop_requested() {
  return stopped != 0;
}

}  // namespace tdpt
