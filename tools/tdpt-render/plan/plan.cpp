#include "tools/tdpt-render/plan/plan.h"

#include <array>

#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt {

namespace {

constexpr uint64_t kSppOfTarget = 64;      // foreseen, while nothing is known
constexpr double kSamplesPerSecond = 2e5;  // foreseen, of a typical scene
constexpr double kCores = 4;               // of the machine for which work is foreseen

// Samples per pixel by the limits alone, before anything is measured; 0: as time allows.
uint64_t spp_foreseen(const Limits& limits) {
  if (limits.target_error == 0) return limits.spp;
  return limits.spp > 0 ? std::min(limits.spp, kSppOfTarget) : kSppOfTarget;
}

// The samples of the whole picture.
double samples_foreseen(const Limits& limits, const FilmPlane& film) {
  const uint64_t spp = spp_foreseen(limits);
  if (spp == 0) return kSamplesPerSecond * limits.seconds;
  return static_cast<double>(spp) * film.width() * film.height();
}

// Draws the pilot in rounds, each as large as all before, until it has had its share of the work.
void draw_pilot(const Session& session, Pilot& pilot, Film& film) {
  const Limits& limits = session.job.limits;
  const auto samples =
      static_cast<double>(spp_foreseen(limits)) * static_cast<double>(session.pixels);
  if (samples > 0 && !can_spare(samples, pilot)) return;
  for (uint64_t n = kFewestGroups; n > 0 && !stop_requested();) {
    pilot.draw(n, film);
    uint64_t enough = kMostGroups;
    if (samples > 0) enough = groups_for(samples, pilot);
    if (limits.seconds > 0)
      enough = std::min(enough, groups_for_work(1e9 * kCores * limits.seconds, pilot));
    n = std::min(pilot.groups(), enough - std::min(enough, pilot.groups()));
  }
  film.clear();
}

void choose_by_pilot(Session& session, const std::vector<Candidate>& candidates, Film& film,
                     Plan& plan) {
  const double cpu = session.cpu();
  Pilot pilot(session.vista, candidates, session.rules, session.renderer.on_device());
  draw_pilot(session, pilot, film);
  plan.pilot_cpu_seconds = session.cpu() - cpu;
  if (pilot.groups() == 0) return;
  plan.forecast = pilot.forecast();
  plan.pilot_samples = pilot.groups() * pilot.samples_of_group();
}

// Where the pilot met no light the picture gets as many samples as it: they may.
void aim_at_error(Session& session, Film& film, Plan& plan) {
  const Limits& limits = session.job.limits;
  if (session.is_dark()) {
    if (plan.spp == 0) plan.spp = session.job.alpha ? 16 : 1;
    return;
  }
  session.make_ready(plan.integrator, film);
  const double cpu = session.cpu();
  Tally tally(film.unit());
  ProgressBar bar("measuring the error", "samples", 0, session.job.quiet);
  const DrawPart draw = [&](uint64_t part,
                            const SampleRange& samples) -> std::optional<std::vector<Vec3d>> {
    if (stop_requested() || (limits.seconds > 0 && session.seconds() > 0.5 * limits.seconds))
      return {};
    film.clear();
    session.renderer.render(plan.integrator, session.rules, kErrorPilotRounds.first + part, samples,
                            film, tally, bar);
    return film.sums();
  };
  ErrorPilot& pilot = plan.error_pilot;
  pilot = run_error_pilot(session.pixels, limits.target_error,
                          limits.spp > 0 ? limits.spp : kMostSamples, draw);
  pilot.cpu_seconds = session.cpu() - cpu;
  uint64_t goal = pilot.needed > 0 ? pilot.needed : pilot.samples();
  if (limits.spp > 0) goal = goal > 0 ? std::min(goal, limits.spp) : limits.spp;
  if (goal == 0 && limits.seconds == 0) goal = kMostSamples;  // a signal will end it
  plan.spp = goal;
}

bool goes_through_portals(const Job& job, const Vista& vista) {
  const Mixture& named = job.named.mixture;
  return job.automatic || named.has(Technique::portal) || named.guiding != Guiding{} ||
         (named.looks_out() && !vista.openings.windows.empty());
}

// By power alone a sky outranks every lamp indoors.
bool competes_with_sky(const Vista& vista) {
  return vista.world->lights.sky() && vista.openings.selection.shares().sky < 1;
}

}  // namespace

std::vector<Candidate> candidates_of(const Job& job, const Vista& vista) {
  if (!job.automatic) return {{job.named, label_of(job.named)}};
  return auto_candidates(vista, job.guided);
}

Explored explore(const Job& job, const Vista& vista, const Camera& camera,
                 const std::vector<Portal>& portals, double samples) {
  Explored nothing;
  nothing.lights = vista.openings.selection.shares();
  // Whether there is more to it than the camera's own ray.
  if (longest_path(vista, job.max_depth, job.alpha) < job.max_depth) return nothing;
  const std::vector<Portal> probed =
      goes_through_portals(job, vista) ? portals : std::vector<Portal>();
  const bool by_arrival = competes_with_sky(vista);
  if (probed.empty() && !by_arrival && job.max_depth >= kMaxDepth) return nothing;
  const double share = job.automatic ? kShareBesidePilot : kShareAlone;
  if (!(samples > 0)) samples = share * samples_foreseen(job.limits, vista.view.film);
  samples = std::clamp(samples, kExplorationFewest, kExplorationEnough);
  Explored explored = explore(vista, camera, probed, job.max_depth, job.seed, samples);
  if (!by_arrival) explored.lights = nothing.lights;
  return explored;
}

Plan make_plan(Session& session, const std::vector<Candidate>& given, Explored explored,
               const std::string& label) {
  const auto candidates = expecting_connections(session.vista, given, session.job.max_depth);
  Film film = session.film_aside();
  Plan plan;
  plan.explored = std::move(explored);
  plan.spp = session.job.limits.spp;
  plan.is_new = label.empty();
  if (plan.is_new && candidates.size() > 1 && !session.is_shorter())
    choose_by_pilot(session, candidates, film, plan);
  auto chosen = candidates.begin() + static_cast<std::ptrdiff_t>(plan.forecast.best);
  if (!plan.is_new)
    chosen = std::find_if(candidates.begin(), candidates.end() - 1,
                          [&](const Candidate& c) { return c.label == label; });
  plan.integrator = chosen->integrator;
  plan.label = chosen->label;
  if (plan.is_new && session.job.limits.target_error > 0) aim_at_error(session, film, plan);
  plan.cut_short = plan.is_new && stop_requested();
  return plan;
}

// The canonical frame puts the whole scene in the cube [-1,1]^3 [Frame].
bool may_see_surfaces(const Vista& vista) {
  if (vista.world->scene.triangles.empty()) return false;
  if (vista.view.blur.any()) return true;  // not worth finding out
  const FilmPlane& film = vista.view.film;
  const double w = film.width(), h = film.height();
  const std::array<Vec3d, 4> edges{film.direction(0, 0), film.direction(w, 0), film.direction(w, h),
                                   film.direction(0, h)};
  for (size_t i = 0; i < 4; ++i) {
    Vec3d inwards = normalize(cross(edges[i], edges[(i + 1) % 4]));
    if (dot(inwards, film.forward()) < 0) inwards = -inwards;
    int outside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d d =
          Vec3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1) - film.position();
      outside += dot(inwards, d) <= -1e-6 * length(d);
    }
    if (outside == 8) return false;
  }
  return true;
}

int longest_path(const Vista& vista, int max_depth, bool alpha) {
  if (vista.world->lights.empty()) return alpha ? 1 : 0;
  if (!may_see_surfaces(vista)) return vista.world->scene.sky ? 1 : 0;
  return max_depth;
}

}  // namespace tdpt
