#include "tools/tdpt-render/run/camera_sight.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "libcommon/base/words.h"

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

// Whether each ray meets the back of a surface, as in a wall.
bool sees_only_backs(const Vista& vista) {
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = direction_of(vista.view.film, i);
    Hit hit;
    if (!vista.world->tracer.first_seen(vista.view.film.position(), w, hit) ||
        dot(hit.normal, w) < 0)
      return false;
  }
  return true;
}

// Whether a wall stands between some points of the lens.
bool lens_is_cut(const Vista& vista) {
  const Vec3d middle = vista.view.film.position();
  for (int i = 0; i < 64; ++i) {
    const FilmPlane drawn =
        vista.view.blur.draw(vista.view.film, (i % 8 + 0.5) / 8, (i / 8 + 0.5) / 8, 0.5);
    if (!vista.world->tracer.visible({middle}, {drawn.position()})) return true;
  }
  return false;
}

}  // namespace

std::string no_backs_sentence(const Vista& vista) {
  if (!vista.world->tracer.culls()) return "";
  for (int i = 0; i < kRays * kRays; ++i)
    if (Hit hit; vista.world->tracer.closest({vista.view.film.position()},
                                             direction_of(vista.view.film, i), hit) &&
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
    if (!vista.world->tracer.first_seen(film.position(), w, hit) ||
        !is_culled_back(vista.world->scene, hit, w))
      continue;
    ++backs;
    ++met[vista.world->scene.triangles[hit.triangle].material];
  }
  const double share = static_cast<double>(backs) / (kRays * kRays);
  if (share < kLeastShare) return "";
  const auto most = std::max_element(met.begin(), met.end());
  const std::string& name =
      vista.world->scene.materials[static_cast<size_t>(most - met.begin())].name;
  return fmt::format(
      "the camera sees the backs of single-sided surfaces in {:.0f} % of the picture, most of all "
      "of {}: glTF viewers do not draw them (--cull)",
      100 * share,
      name.empty() ? fmt::format("materials[{}]", most - met.begin())
                   : "material \"" + shown(name, 60) + "\"");
}

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

std::string why_black(const Vista& vista) {
  if (sees_only_backs(vista))
    return "the camera sees only backs of surfaces: does it stand in a wall?";
  if (vista.view.blur.any() && lens_is_cut(vista))
    return "surfaces cut through the lens of the camera: is --f-stop too small?";
  return "are the samples too few, or is a door shut?";
}

}  // namespace tdpt
