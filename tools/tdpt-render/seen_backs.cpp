#include "tools/tdpt-render/seen_backs.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/shown.h"

namespace tdpt {
namespace {

constexpr int kRays = 32;             // along each side of the film
constexpr double kLeastShare = 0.01;  // that is worth a word

}  // namespace

SeenBacks seen_backs(const World& world) {
  const FilmPlane& film = world.film;
  std::vector<int> met(world.scene.materials.size());
  int backs = 0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3d w = film.direction((i % kRays + 0.5) / kRays * film.width(),
                                   (i / kRays + 0.5) / kRays * film.height());
    Hit hit;
    if (!world.tracer.first_seen(film.position(), w, hit) || !(dot(hit.normal, w) > 0) ||
        !world.scene.single_sided(hit.triangle))
      continue;
    ++backs;
    ++met[world.scene.triangles[hit.triangle].material];
  }
  SeenBacks seen{static_cast<double>(backs) / (kRays * kRays), {}};
  const auto most = std::max_element(met.begin(), met.end());
  if (backs > 0)
    seen.material = world.scene.materials[static_cast<size_t>(most - met.begin())].name;
  return seen;
}

std::string backs_sentence(const SeenBacks& seen) {
  if (seen.share < kLeastShare) return "";
  return fmt::format(
      "the camera sees the backs of single-sided surfaces in {:.0f} % of the picture, most of all "
      "of material \"{}\": glTF viewers do not draw them (--cull)",
      100 * seen.share, shown(seen.material, 60));
}

}  // namespace tdpt
