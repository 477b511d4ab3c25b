// Plans and renders for tests, without exploring: portals work as drawn.
#pragma once
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

inline RenderResult render(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                           const Job& job) {
  Session session(renderer, job);
  Explored explored;
  explored.lights = session.vista.openings.selection.shares();
  const Plan plan = make_plan(session, candidates, explored);
  return render(session, plan, std::make_shared<Progress>(new_progress(session, candidates, plan)));
}

inline RenderResult render(SampleRenderer& renderer, const Integrator& integrator, const Job& job) {
  return render(renderer, std::vector<Candidate>{{integrator, integrator.name}}, job);
}

inline RenderResult render(const Vista& vista, const std::vector<Candidate>& candidates,
                           const Job& job) {
  CpuRenderer cpu(vista);
  return render(cpu, candidates, job);
}

inline RenderResult render(const Vista& vista, const Integrator& integrator, const Job& job) {
  return render(vista, std::vector<Candidate>{{integrator, integrator.name}}, job);
}

}  // namespace tdpt
