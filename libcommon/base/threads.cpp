#include "libcommon/base/threads.h"

#include <ctime>
#include <memory>

#include <oneapi/tbb/global_control.h>

namespace tdpt {

void limit_threads(int n) {
  static std::unique_ptr<tbb::global_control> control;
  if (n > 0)
    control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<size_t>(n));
}

double cpu_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace tdpt
