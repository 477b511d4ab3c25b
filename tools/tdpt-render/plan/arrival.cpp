#include "tools/tdpt-render/plan/arrival.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "tools/tdpt-render/integrators/spread_pixels.h"

namespace tdpt {
namespace {

constexpr size_t kSamples = 4096, kChunk = 64;
constexpr int kDeepest = 8;         // edges
constexpr double kKept = 0.1;       // of a share by power
constexpr double kBrightest = 0.1;  // most of all that one path may tell

void add(Lights::Shares& sum, const Lights::Shares& s, double factor) {
  sum.surfaces += factor * s.surfaces;
  sum.lamps += factor * s.lamps;
  sum.parallel += factor * s.parallel;
  sum.sky += factor * s.sky;
}
double total(const Lights::Shares& s) {
  return s.surfaces + s.lamps + s.parallel + s.sky;
}

}  // namespace

Lights::Shares arriving_shares(const World& world, const SampleRules& rules) {
  const SampleSettings how{nee.mixture, std::min(rules.max_depth, kDeepest), 1, rules.seed,
                           stream_in(kArrivalRound.first, nee.stream)};
  Film film(world.film.width(), world.film.height(), world.lights.power());
  std::vector<std::vector<std::pair<const LightSource*, double>>> found(kSamples / kChunk);
  tbb::parallel_for(size_t{0}, found.size(), [&](size_t c) {
    const PathObserver observer = [&](const Contribution& path) {
      if (path.path.k() < 2) return;  // that it is seen needs no choice
      const double light = luminance(path.value) * path.path.weight(how.mixture, path.strategy, 1);
      if (std::isfinite(light)) found[c].push_back({path.path.vertex(0).source, light});
    };
    Tally tally(film.unit());
    PathSampler sampler(world, how, film, tally, &observer);
    for (size_t k = c * kChunk; k < (c + 1) * kChunk; ++k) {
      const auto [x, y] = spread_pixel(k, world.film.width(), world.film.height());
      sampler.sample(x, y, k);
    }
  });
  double all = 0;
  for (const auto& chunk : found)
    for (const auto& [source, light] : chunk) all += light;
  Lights::Shares arrived, shares;
  for (const auto& chunk : found)
    for (const auto& [source, light] : chunk)
      arrived.of(*source) += std::min(light, kBrightest * all);
  const double sum = total(arrived);
  if (!(sum > 0)) return world.lights.shares();
  add(shares, world.lights.shares(), kKept);
  add(shares, arrived, (1 - kKept) / sum);
  return shares;
}

}  // namespace tdpt
