#include "tools/tdpt-render/integrators/passes.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt {

void CpuRenderer::render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
                         const SampleRange& samples, Film& film, Tally& tally,
                         ProgressBar& progress) {
  const SampleSettings settings{integrator.mixture, rules.max_depth, rules.beta, rules.seed,
                                stream_in(round, integrator.stream)};
  const auto width = static_cast<uint64_t>(vista.view.film.width());
  const uint64_t pixels = width * static_cast<uint64_t>(vista.view.film.height());
  // A cache spans pixels far apart, so that their shared light walks do not show as correlated
  // noise.
  const uint64_t per_cache = samples_of_cache(integrator.mixture);
  const uint64_t caches = (pixels + per_cache - 1) / per_cache;
  const uint64_t in_task = (width + per_cache - 1) / per_cache;
  std::vector<Tally> tallies((caches + in_task - 1) / in_task, Tally(film.unit()));
  tbb::parallel_for(size_t{0}, tallies.size(), [&](size_t task) {
    PathSampler sampler(vista, settings, film, tallies[task]);
    std::vector<Walk> light_walks(light_walks_of(integrator.mixture, per_cache));
    const Walk none;
    LightVertexCache cache;
    // Visits the first `count` pixels of cache `first`.
    const auto each = [&](uint64_t first, uint64_t count, uint64_t sample, const auto& visit) {
      for (uint64_t i = 0; i < count; ++i) {
        const uint64_t p = pixel_of_cache(first, i, caches, pixels);
        sampler.begin(static_cast<int>(p % width), static_cast<int>(p / width), sample);
        visit(i);
      }
    };
    const uint64_t begin = task * in_task, end = std::min(caches, begin + in_task);
    uint64_t done = 0;
    for (uint64_t first = begin; first < end; ++first) {
      const uint64_t in_cache = (pixels - first + caches - 1) / caches;
      const uint64_t walks = light_walks_of(integrator.mixture, in_cache);
      for (uint64_t i = 0; i < samples.count; ++i) {
        const uint64_t sample = samples.first + i;
        cache.clear(in_cache);
        each(first, walks, sample, [&](uint64_t w) {
          sampler.light_phase(light_walks[w]);
          cache.add(light_walks[w]);
        });
        if (sampler.has_segment_phase())
          each(first, in_cache, sample, [&](uint64_t w) {
            sampler.segment_phase(w < walks ? light_walks[w] : none, cache);
          });
        each(first, in_cache, sample, [&](uint64_t w) {
          sampler.camera_phase(w < walks ? light_walks[w] : none, cache);
          sampler.end();
          ++done;
        });
      }
    }
    progress.advance(done);
  });
  for (const Tally& part : tallies) tally.merge(part);
  film.complete(samples);
}

Film::Options film_options(const TechniqueSet& layers, bool alpha, bool halves) {
  Film::Options options;
  for (size_t t = 0; t < kTechniques; ++t)
    options.layers.push_back(layers.has(static_cast<Technique>(t)) ? kTechniqueNames[t] : "");
  options.alpha = alpha;
  options.halves = halves;
  return options;
}

Film film_for(const Vista& vista, const TechniqueSet& layers, bool alpha, bool halves) {
  return Film(vista.view.film.width(), vista.view.film.height(), vista.world->lights.power(),
              film_options(layers, alpha, halves));
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
