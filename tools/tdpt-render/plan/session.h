// What the phases of one rendering share: renderer, settings and clock.
#pragma once
#include <algorithm>
#include <chrono>

#include "libcommon/base/threads.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/longest_path.h"
#include "tools/tdpt-render/plan/settings.h"

namespace tdpt {

/// Wall-clock and CPU time of rendering [s], not counting what runs in aside().
class WorkClock {
 public:
  /// `seconds`, `cpu`: spent before.
  WorkClock(double seconds, double cpu) : aside_(-seconds), cpu_aside_(-cpu) {}
  double seconds() const { return since_start() - aside_; }
  double cpu() const { return cpu_seconds() - cpu_start_ - cpu_aside_; }
  template <class Work>
  void aside(const Work& work) {
    const double seconds = since_start(), cpu = cpu_seconds();
    work();
    aside_ += since_start() - seconds;
    cpu_aside_ += cpu_seconds() - cpu;
  }

 private:
  using Steady = std::chrono::steady_clock;
  double since_start() const {
    return std::chrono::duration<double>(Steady::now() - start_).count();
  }
  const Steady::time_point start_ = Steady::now();
  const double cpu_start_ = cpu_seconds();
  double aside_, cpu_aside_;
};

struct Session {
  /// `seconds`, `cpu`: spent before.
  Session(SampleRenderer& renderer_, const RenderSettings& settings_, double seconds = 0,
          double cpu = 0)
      : renderer(renderer_),
        world(renderer_.world),
        settings(settings_),
        longest(longest_path(world, settings_.max_depth, settings_.alpha)),
        rules{std::max(longest, 1), settings_.beta, settings_.seed},
        pixels(static_cast<uint64_t>(world.film.width()) *
               static_cast<uint64_t>(world.film.height())),
        clock(seconds, cpu) {}

  SampleRenderer& renderer;
  const World& world;
  const RenderSettings& settings;
  const int longest;  ///< path that can carry light [edges]; 0: none can
  const SampleRules rules;
  const uint64_t pixels;
  WorkClock clock;

  /// Call before the first samples of any kind; the renderer's preparation is not timed.
  void make_ready(const Integrator& integrator, const Film& film) {
    if (ready_) return;
    ready_ = true;
    clock.aside([&] { renderer.prepare(integrator, rules, film, settings.quiet); });
  }
  /// A film for samples that are thrown away.
  Film film_aside() const { return film_for(world, TechniqueSet()); }

 private:
  bool ready_ = false;
};

}  // namespace tdpt
