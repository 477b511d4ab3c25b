#include "tools/tdpt-render/run/seen_backs.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/shown.h"

namespace tdpt {
namespace {

constexpr int kRays = 32;             // along each side of the film
constexpr double kLeastShare = 0.01;  // below which there is no warning

Vec3d direction_of(const FilmPlane& film, int ray) {
  return film.direction((ray % kRays + 0.5) / kRays * film.width(),
                        (ray / kRays + 0.5) / kRays * film.height());
}

bool is_culled_back(const Scene& scene, const Hit& hit, const Vec3d& w) {
  return dot(hit.normal, w) > 0 && scene.single_sided(hit.triangle);
}

}  // namespace

std::string no_backs_sentence(const Vista& vista) {
  if (!vista.world->tracer.culls()) return "";
  for (int i = 0; i < kRays * kRays; ++i)
    if (Hit hit; vista.world->tracer.closest({vista.view.film.position()}, direction_of(vista.view.film, i), hit) &&
                 is_culled_back(vista.world->scene, hit, direction_of(vista.view.film, i)))
      return "";
  return "no back of a single-sided surface is in the camera's way: --cull changes nothing";
}

std::string backs_sentence(const Vista& vista) {
  const FilmPlane& film = vista.view.film;
  std::vector<int> met(vista.world->scene.materials.size());
  int backs = 0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = direction_of(film, i);
    Hit hit;
    if (!vista.world->tracer.first_seen(film.position(), w, hit) || !is_culled_back(vista.world->scene, hit, w))
      continue;
    ++backs;
    ++met[vista.world->scene.triangles[hit.triangle].material];
  }
  const double share = static_cast<double>(backs) / (kRays * kRays);
  if (share < kLeastShare) return "";
  const auto most = std::max_element(met.begin(), met.end());
  const std::string& name = vista.world->scene.materials[static_cast<size_t>(most - met.begin())].name;
  return fmt::format(
      "the camera sees the backs of single-sided surfaces in {:.0f} % of the picture, most of all "
      "of {}: glTF viewers do not draw them (--cull)",
      100 * share,
      name.empty() ? fmt::format("materials[{}]", most - met.begin())
                   : "material \"" + shown(name, 60) + "\"");
}

bool sees_only_backs(const Vista& vista) {
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = direction_of(vista.view.film, i);
    Hit hit;
    if (!vista.world->tracer.first_seen(vista.view.film.position(), w, hit) || dot(hit.normal, w) < 0)
      return false;
  }
  return true;
}

}  // namespace tdpt
