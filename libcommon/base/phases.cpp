#include "libcommon/base/phases.h"

#include <algorithm>
#include <chrono>

#include <sys/resource.h>

#include "libcommon/base/threads.h"

namespace tdpt {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Phases::Phases() : wall_(wall_seconds()), cpu_(cpu_seconds()) {}

void Phases::done(const std::string& name) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  auto phase =
      std::find_if(phases_.begin(), phases_.end(), [&](const Phase& p) { return p.name == name; });
  if (phase == phases_.end()) phase = phases_.insert(phase, {name, 0, 0});
  phase->seconds += wall - wall_;
  phase->cpu_seconds += cpu - cpu_;
  wall_ = wall;
  cpu_ = cpu;
}

int64_t peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace tdpt
