// What is asked of the renderer, parsed and checked once; what the phases of one rendering share:
// renderer, job and clock; and what is decided before the first sample of a picture: who renders,
// how often, and how portals and lights are used. Decisions hang on counted work and on samples
// that are thrown away, never on the clock: the same command decides the same on every machine and
// in every part of a picture.
#pragma once
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "libcommon/base/process.h"
#include "tools/tdpt-render/integrators/passes.h"
#include "tools/tdpt-render/plan/exploration.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/plan/pilot.h"

namespace tdpt {

/// Largest number of samples per pixel, as for --spp.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 32;

/// What ends a rendering; 0: no such limit.
struct Limits {
  uint64_t spp = 0;         ///< samples per pixel; 0: what fits into `seconds`, or the target needs
  double seconds = 0;       ///< wall-clock limit of rendering alone
  double target_error = 0;  ///< relMSE to reach, within the limits of spp and seconds
  friend bool operator==(const Limits&, const Limits&) = default;
};

struct Job {
  Limits limits;
  bool automatic = false;           ///< the pilot chooses the integrator [pilot.h]
  Integrator named = bdpt;          ///< renders if not automatic
  Integrator guided = tdpt_guided;  ///< `auto` tries it, with the numbers given
  int max_depth = kMaxDepth;        ///< edges
  double beta = 1;                  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  bool quiet = true;
  bool alpha = false;   ///< transparent film: the sky in the background is left out
  bool layers = false;  ///< keep each technique's contribution separately
  bool halves = false;  ///< keep the samples with odd numbers separately
  bool frames = false;  ///< measure the unfinished picture
};

/// False only if the camera's view pyramid misses the whole scene.
bool may_see_surfaces(const Vista& vista);
/// The longest path that can bring light to this picture [edges]: longer ones are not sampled. 0:
/// the picture is black, for want of light or of anything to see; 1: it shows only the sky, or
/// `alpha` of a dark scene is asked for; otherwise `max_depth`.
int longest_path(const Vista& vista, int max_depth, bool alpha);

class Session {
 public:
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

  /// Whether only the camera's own rays can bring light, if any.
  bool is_shorter() const { return longest < job.max_depth || vista.world->lights.empty(); }
  bool is_dark() const { return longest == 0 || vista.world->lights.empty(); }

  /// Call before the first samples of any kind; the renderer's preparation is not timed.
  void make_ready(const Integrator& integrator, const Film& film) {
    if (ready_) return;
    ready_ = true;
    aside([&] { renderer.prepare(integrator, rules, film, job.quiet); });
  }
  /// A film for samples that are thrown away.
  Film film_aside() const { return film_for(vista, TechniqueSet()); }

  /// Wall-clock and CPU time of rendering [s], not counting what runs in aside().
  double seconds() const { return since_start() - aside_; }
  double cpu() const { return cpu_seconds() - cpu_start_ - cpu_aside_; }
  /// Counts what was spent before.
  void add_time(double seconds, double cpu) { aside_ -= seconds, cpu_aside_ -= cpu; }
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
  bool ready_ = false;
};

struct Plan {
  Integrator integrator = bdpt;  ///< renders, with its expected connections
  std::string label;             ///< of the candidate; several share an integrator's name
  uint64_t spp = 0;              ///< samples per pixel; 0: as many as the time allows
  Explored explored;

  // What was measured besides, reported with the picture.
  Forecast forecast;           ///< of the candidates; without estimates if no pilot ran
  uint64_t pilot_samples = 0;  ///< behind the forecast
  double pilot_cpu_seconds = 0;
  ErrorPilot error_pilot;  ///< if there is a target error

  bool is_new = true;      ///< false: decided by the run that began the picture
  bool cut_short = false;  ///< by a signal: another run would decide otherwise
};

/// The one integrator that is named, or the candidates of `auto` [candidates.h].
std::vector<Candidate> candidates_of(const Job& job, const Vista& vista);

/// What of the exploration matters for this job: nothing for portals that nothing goes through, and
/// for kinds of light that do not compete with a sky. `samples`: of the exploration that the
/// picture was begun with; 0: as many as the limits allow.
Explored explore(const Job& job, const Vista& vista, const Camera& camera,
                 const std::vector<Portal>& portals, double samples = 0);

/// The best candidate, found by a pilot if the budget allows one [pilot.h], else the first; and for
/// a target error the number of samples [noise.h]. The renderer's portals and lights must
/// be as `explored` says. `label`: of the candidate that renders, if that is decided already, by
/// the run that a picture was begun with: then nothing is measured.
Plan make_plan(Session& session, const std::vector<Candidate>& candidates, Explored explored,
               const std::string& label = "");

}  // namespace tdpt
