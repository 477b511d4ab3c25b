// Method: a ratio of two sums over groups of samples that pool their light walks; its error from
// the groups (delta method).
#include "tools/tdpt-render/plan/beyond.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/number_words.h"
#include "tools/tdpt-render/integrators/spread_pixels.h"

namespace tdpt {
namespace {

struct Group {
  double within = 0, beyond = 0;  // luminance
};

void add_group(PathSampler& sampler, const World& world, uint64_t group) {
  std::vector<Walk> walks(LightPool::kWalks);
  LightPool pool;
  pool.clear(walks.size());
  const auto each = [&](const auto& visit) {
    for (uint64_t i = 0; i < walks.size(); ++i) {
      const uint64_t k = group * walks.size() + i;
      const auto [x, y] = spread_pixel(k, world.film.width(), world.film.height());
      sampler.begin(x, y, k << 32);  // runs of 2^32 samples of a pixel are independent
      visit(walks[i]);
    }
  };
  if (sampler.has_light_phase())
    each([&](Walk& walk) {
      sampler.light_phase(walk);
      pool.add(walk);
    });
  if (sampler.has_segment_phase())
    each([&](const Walk& walk) { sampler.segment_phase(walk, pool); });
  each([&](const Walk& walk) { sampler.camera_phase(walk, pool); });
}

}  // namespace

Beyond light_beyond(const World& world, const Integrator& integrator, const SampleRules& rules,
                    double samples, Film& film) {
  // Its samples are few: each makes a light walk, and pools are as small as that.
  Mixture mixture = integrator.mixture;
  mixture.light_walks = 1;
  mixture.segments_joined = std::min<double>(mixture.segments_joined, LightPool::kWalks);
  const SampleSettings how{mixture, kMaxDepth, rules.beta, rules.seed,
                           stream_in(kBeyondRound.first, integrator.stream)};
  std::vector<Group> groups(
      static_cast<size_t>(std::clamp(samples, 64.0, 16384.0) / LightPool::kWalks));
  tbb::parallel_for(size_t{0}, groups.size(), [&](size_t g) {
    Group& group = groups[g];
    const PathObserver observer = [&](const Contribution& found) {
      const double light =
          luminance(found.value) * found.path.weight(how.mixture, found.strategy, how.beta);
      if (std::isfinite(light))
        (found.path.k() > rules.max_depth ? group.beyond : group.within) += light;
    };
    Tally tally(film.unit());
    PathSampler sampler(world, how, film, tally, &observer);
    add_group(sampler, world, g);
  });
  Beyond result{rules.max_depth, 0, 0};
  double all = 0, beyond = 0, squares = 0;
  for (const Group& g : groups) {
    all += g.within + g.beyond;
    beyond += g.beyond;
  }
  if (!(all > 0)) return result;
  result.share = beyond / all;
  for (const Group& g : groups) {
    const double off = g.beyond - result.share * (g.within + g.beyond);
    squares += off * off;
  }
  result.error = std::sqrt(squares) / all;
  return result;
}

std::string sentence(const Beyond& beyond) {
  const double most = beyond.share + 2 * beyond.error;
  const std::string depth = fmt::format("depth {} leaves out ", beyond.depth);
  if (beyond.share > 0.995) return depth + "all of the light, or nearly";
  if (most < 0.001) return depth + "less than 0.1 % of the light";
  if (beyond.error > 0.25 * beyond.share)
    return depth + fmt::format("at most about {} of the light", percent_words(most));
  return depth + fmt::format("about {} of the light", percent_words(beyond.share));
}

}  // namespace tdpt
