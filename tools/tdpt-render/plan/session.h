// What the phases of one rendering share: renderer, job and clock.
#pragma once
#include <algorithm>
#include <chrono>

#include "libcommon/base/threads.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/job.h"
#include "tools/tdpt-render/plan/longest_path.h"

namespace tdpt {

/// Wall-clock and CPU time of rendering [s], not counting what runs in aside().
class WorkClock {
 public:
  double seconds() const { return since_start() - aside_; }
  double cpu() const { return cpu_seconds() - cpu_start_ - cpu_aside_; }
  /// Counts what was spent before.
  void add(double seconds, double cpu) { aside_ -= seconds, cpu_aside_ -= cpu; }
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
  double aside_ = 0, cpu_aside_ = 0;
};

struct Session {
  Session(SampleRenderer& renderer_, const Job& job_)
      : renderer(renderer_),
        vista(renderer_.vista),
        job(job_),
        longest(longest_path(vista, job_.max_depth, job_.alpha)),
        rules{std::max(longest, 1), job_.beta, job_.seed},
        pixels(vista.view.film.pixels()) {}

  SampleRenderer& renderer;
  const Vista& vista;
  const Job& job;
  const int longest;  ///< path that can carry light [edges]; 0: none can
  const SampleRules rules;
  const uint64_t pixels;
  WorkClock clock;

  /// Whether only the camera's own rays can bring light, if any.
  bool is_shorter() const { return longest < job.max_depth || vista.world->lights.empty(); }
  bool is_dark() const { return longest == 0 || vista.world->lights.empty(); }

  /// Call before the first samples of any kind; the renderer's preparation is not timed.
  void make_ready(const Integrator& integrator, const Film& film) {
    if (ready_) return;
    ready_ = true;
    clock.aside([&] { renderer.prepare(integrator, rules, film, job.quiet); });
  }
  /// A film for samples that are thrown away.
  Film film_aside() const { return film_for(vista, TechniqueSet()); }

 private:
  bool ready_ = false;
};

}  // namespace tdpt
