#include "tools/tdpt-render/plan/decision.h"

#include <algorithm>

#include "libcommon/base/signals.h"

namespace tdpt {
namespace {

std::optional<int> shorter(const Session& session) {
  if (session.longest < session.settings.max_depth || session.world.lights.empty())
    return session.longest;
  return {};
}

// Draws the pilot in rounds, each as large as all before, so that a short time limit is hardly
// exceeded.
void look_around(const Session& session, Pilot& pilot, Film& film) {
  const RenderSettings& settings = session.settings;
  const auto spp = static_cast<double>(spp_foreseen(settings));
  const bool by_clock = settings.seconds > 0;
  const double time = 0.5 * kPilotShare * settings.seconds;  // the last round takes the other half
  if (spp > 0 && !can_spare(spp, session.pixels, pilot)) return;
  for (uint64_t n = kFewestGroups; n > 0 && !stop_requested();) {
    pilot.draw(n, film);
    if (by_clock && session.clock.seconds() > time) break;
    const uint64_t enough = spp > 0 ? groups_for(spp, session.pixels, pilot) : kMostGroups;
    n = std::min(pilot.groups(), enough - std::min(enough, pilot.groups()));
  }
  film.clear();
}

void choose_by_pilot(Session& session, const std::vector<Candidate>& candidates, Film& film,
                     Decision& out) {
  const double cpu = session.clock.cpu();
  Pilot pilot(session.world, candidates, session.rules,
              session.renderer.on_device() ? kDeviceWork : kCpuWork);
  look_around(session, pilot, film);
  out.pilot_cpu_seconds = session.clock.cpu() - cpu;
  if (pilot.groups() > 0) {
    out.forecast = pilot.forecast();
    out.chosen = out.forecast.best;
    out.pilot_samples = pilot.groups() * pilot.samples_of_group();
  }
  out.plan.integrator = candidates[out.chosen].integrator;
  out.plan.label = out.chosen_label = candidates[out.chosen].label;
}

}  // namespace

Decision decided(Session& session, const std::vector<Candidate>& candidates, const Known& known,
                 Film& film) {
  Decision out;
  out.plan = {candidates[0].integrator,      candidates[0].label, session.settings.spp, known.ways,
              session.world.lights.shares(), known.beyond};
  out.longest = shorter(session);
  if (candidates.size() > 1) {
    out.chosen_label = candidates[0].label;
    if (!out.longest) choose_by_pilot(session, candidates, film, out);
  }
  out.count = count_samples(session, out.plan.integrator, film);
  if (out.count.measured) out.plan.spp = out.count.goal;
  out.cut_short = stop_requested();
  return out;
}

Decision obeyed(const Plan& plan, const Session& session,
                const std::vector<Candidate>& candidates) {
  Decision out;
  out.plan = plan;
  out.count.goal = plan.spp;
  out.longest = shorter(session);
  if (candidates.size() < 2) return out;
  out.chosen_label = plan.label;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].label == plan.label) out.chosen = i;
  return out;
}

}  // namespace tdpt
