#include "tools/tdpt-render/run/focus.h"

#include <limits>
#include <vector>

namespace tdpt {

double distance_in_the_middle(const World& world, const FilmPlane& film) {
  std::vector<uint32_t> passed;
  Tracer::Sheet sheet;
  double passes = 1;
  while (world.tracer.first_sheet_seen(film.position(), film.forward(), passed, sheet)) {
    passes *= 1 - sheet.coverage;
    if (passes < 0.5) return sheet.hit.distance;
    passed.push_back(sheet.hit.triangle);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace tdpt
