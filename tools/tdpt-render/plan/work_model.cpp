#include "tools/tdpt-render/plan/work_model.h"

#include <algorithm>
#include <cmath>

namespace tdpt {

const WorkCosts& work_costs(const Vista& vista, const Mixture& mixture, bool on_device) {
  const bool with_portals = Guide(vista, mixture).sees_portals();
  if (on_device) return with_portals ? kDeviceWorkWithPortals : kDeviceWorkWithoutPortals;
  return with_portals ? kWorkWithPortals : kWorkWithoutPortals;
}

double sample_work(const Vista& vista, const Mixture& mixture, const WorkCosts& costs,
                   const RayCounts& rays, uint64_t samples) {
  const Openings& openings = vista.openings;
  const double depth =
      std::max(0.0, std::log2(static_cast<double>(vista.world->scene.triangles.size() + 1) / 64));
  double closest = costs.closest + costs.closest_deeper * depth;
  if (!openings.windows.empty() && mixture.looks_out())
    closest +=
        costs.looking_out + costs.window * static_cast<double>(openings.windows.windows().size());
  const auto size = static_cast<int>(openings.portals.size());
  double portal = costs.portal + costs.portal_triangle * size;
  if (size > 0 && mixture.guiding != Guiding{}) {
    const double facets = 1.0 + openings.portals.polygon(size - 1).facet;
    portal += costs.directed + (facets > 1 ? costs.facets + costs.facet * facets : 0);
  }
  const double n = static_cast<double>(std::max<uint64_t>(samples, 1));
  return costs.sample + closest * static_cast<double>(rays.closest) / n +
         costs.shadow * static_cast<double>(rays.shadow) / n +
         costs.connect * static_cast<double>(rays.connect) / n +
         portal * static_cast<double>(rays.portal) / n;
}

}  // namespace tdpt
