#include "tools/tdpt-render/plan/work_model.h"

#include <algorithm>
#include <cmath>

namespace tdpt {

WorkModel::WorkModel(const Vista& vista, const Mixture& mixture, const WorkTables& tables)
    : WorkModel(
          vista, mixture,
          Guide(vista, mixture).sees_portals() ? tables.with_portals : tables.without_portals) {}

WorkModel::WorkModel(const Vista& vista, const Mixture& mixture, const WorkCosts& costs)
    : sample_(costs.sample), shadow_(costs.shadow), connect_(costs.connect) {
  const double depth =
      std::max(0.0, std::log2(static_cast<double>(vista.world->scene.triangles.size() + 1) / 64));
  closest_ = costs.closest + costs.closest_deeper * depth;
  if (!vista.openings.windows.empty() && mixture.looks_out())
    closest_ += costs.looking_out +
                costs.window * static_cast<double>(vista.openings.windows.windows().size());
  const auto size = static_cast<int>(vista.openings.portals.size());
  portal_ = costs.portal + costs.portal_triangle * size;
  if (size == 0 || mixture.guiding == Guiding{}) return;
  const double facets = 1.0 + vista.openings.portals.polygon(size - 1).facet;
  portal_ += costs.directed + (facets > 1 ? costs.facets + costs.facet * facets : 0);
}

double WorkModel::per_sample(const RayCounts& rays, uint64_t samples) const {
  const double n = static_cast<double>(std::max<uint64_t>(samples, 1));
  return sample_ + closest_ * static_cast<double>(rays.closest) / n +
         shadow_ * static_cast<double>(rays.shadow) / n +
         connect_ * static_cast<double>(rays.connect) / n +
         portal_ * static_cast<double>(rays.portal) / n;
}

}  // namespace tdpt
