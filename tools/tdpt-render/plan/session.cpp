#include "tools/tdpt-render/plan/session.h"

#include <algorithm>
#include <array>

namespace tdpt {
namespace {

// The canonical frame puts the whole scene in the cube [-1,1]^3 [Frame].
bool beyond(const Vec3d& inwards, const Vec3d& apex) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d at(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Vec3d d = at - apex;
    if (dot(inwards, d) > -1e-6 * length(d)) return false;
  }
  return true;
}

}  // namespace

bool may_see_surfaces(const Vista& vista) {
  if (vista.world->scene.triangles.empty()) return false;
  if (vista.view.blur.any()) return true;  // not worth finding out
  const FilmPlane& film = vista.view.film;
  const double w = film.width(), h = film.height();
  const std::array<Vec3d, 4> edges{film.direction(0, 0), film.direction(w, 0), film.direction(w, h),
                                   film.direction(0, h)};
  for (size_t i = 0; i < 4; ++i) {
    const Vec3d side = normalize(cross(edges[i], edges[(i + 1) % 4]));
    if (beyond(dot(side, film.forward()) < 0 ? -side : side, film.position())) return false;
  }
  return true;
}

int longest_path(const Vista& vista, int max_depth, bool alpha) {
  if (vista.world->lights.empty()) return alpha ? 1 : 0;
  if (!may_see_surfaces(vista)) return vista.world->scene.sky ? 1 : 0;
  return max_depth;
}

}  // namespace tdpt
