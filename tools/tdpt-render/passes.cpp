#include "tools/tdpt-render/passes.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt {

void render_samples(const World& world, const Integrator& integrator, const SampleRules& rules,
                    uint64_t round, const SampleRange& samples, Film& film, Tally& tally,
                    Progress& progress) {
  const SampleSettings settings{integrator.mixture, rules.max_depth, rules.beta, rules.seed,
                                integrator.stream + (kStreams + 1) * round};
  const int width = world.film.width(), height = world.film.height();
  std::vector<Tally> rows(static_cast<size_t>(height), Tally(film.unit()));
  tbb::parallel_for(0, height, [&](int y) {
    PathSampler sampler(world, settings, film, rows[static_cast<size_t>(y)]);
    // Those of pixels far apart, so that what they have in common is not seen.
    const int apart = (width + LightPool::kWalks - 1) / LightPool::kWalks;
    std::vector<Walk> light_walks(LightPool::kWalks);
    LightPool pool;
    const auto each = [&](int first, uint64_t sample, const auto& visit) {
      size_t i = 0;
      for (int x = first; x < width; x += apart) {
        sampler.begin(x, y, sample);
        visit(light_walks[i++]);
      }
    };
    for (int first = 0; first < apart; ++first)
      for (uint64_t i = 0; i < samples.count; ++i) {
        const uint64_t sample = samples.first + i;
        pool.clear();
        if (sampler.has_light_phase())
          each(first, sample, [&](Walk& walk) {
            sampler.light_phase(walk);
            pool.add(walk);
          });
        each(first, sample, [&](Walk& walk) {
          sampler.camera_phase(walk, pool);
          sampler.end();
        });
      }
    progress.advance(static_cast<uint64_t>(width) * samples.count);
  });
  for (const Tally& row : rows) tally.merge(row);
  film.complete(samples);
}

Film film_for(const World& world, const TechniqueSet& layers) {
  Film::Options options;
  options.layers = layers.bits();
  return Film(world.film.width(), world.film.height(), world.lights.power(), options);
}

void RenderTally::add(const Tally& tally) {
  rays.merge(tally.rays);
  for (size_t i = 0; i < kTechniques; ++i) energy[i] += tally.energy[i];
  for (size_t i = 0; i < Tally::kOctaves; ++i) by_length[i] += tally.by_length[i];
  if (portals.size() < tally.portals.size()) portals.resize(tally.portals.size());
  for (size_t i = 0; i < tally.portals.size(); ++i) {
    portals[i].drawn += tally.portals[i].drawn;
    portals[i].lit += tally.portals[i].lit;
    portals[i].energy += tally.portals[i].energy;
  }
  not_finite += tally.not_finite;
  not_finite_at.insert(not_finite_at.end(), tally.not_finite_at.begin(), tally.not_finite_at.end());
  if (not_finite_at.size() > Tally::kMostPlaces) not_finite_at.resize(Tally::kMostPlaces);
}

}  // namespace tdpt
