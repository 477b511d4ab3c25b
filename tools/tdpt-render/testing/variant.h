// For tests: variants of integrators, with planted faults for twins.
#pragma once
#include <cmath>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

/// The rows of the table.
inline std::vector<const Integrator*> integrators() {
  std::vector<const Integrator*> rows;
  for (const Integrator& row : kIntegrators) rows.push_back(&row);
  return rows;
}

struct Variant {
  Variant(const Integrator& integrator_) : integrator(integrator_) {}  // without a fault
  Variant(const Integrator& integrator_, void (*run_)(PathSampler&))
      : integrator(integrator_), run(run_) {}
  /// Weighed as `techniques`, but with other samples.
  Variant(TechniqueSet techniques, void (*run_)(PathSampler&))
      : integrator{"faulty", 9, {techniques}}, run(run_) {}

  /// As pictures are rendered [passes.h]: light walks are cached, and the weights expect the real
  /// number of connections.
  static Variant cached(const Vista& vista, const Integrator& integrator, int max_depth) {
    Variant v(integrator);
    v.caches = true;
    v.integrator.mixture = expecting_connections(vista, integrator.mixture, max_depth);
    return v;
  }

  SampleSettings settings(int max_depth, uint64_t seed) const {
    return {integrator.mixture, max_depth, beta[0], seed, integrator.stream};
  }
  void sample(PathSampler& sampler, int x, int y, uint64_t s) const {
    sampler.begin(x, y, s);
    run(sampler);
    sampler.end();
  }
  /// Samples 0..spp-1 of all pixels. `at(x, y)` is called before each.
  template <class At>
  void picture(PathSampler& sampler, int width, int height, uint64_t spp, const At& at) const;

  Integrator integrator;
  bool caches = false;
  /// MIS exponent for each technique's samples; the weights sum to 1 only if it is the same.
  std::array<double, kTechniques> beta{1, 1, 1, 1, 1};
  void (*run)(PathSampler&) = [](PathSampler& sampler) { sampler.run(); };
  /// Factor of the number of samples that a cache's light walks are counted for.
  double counted_samples = 1;
  /// What a sample with caches does besides its phases.
  void (*besides)(PathSampler&) = [](PathSampler&) {};
};

template <class At>
void Variant::picture(PathSampler& sampler, int width, int height, uint64_t spp,
                      const At& at) const {
  const auto pixels = static_cast<uint64_t>(width * height);
  const uint64_t per_cache = caches ? samples_of_cache(integrator.mixture) : 1;
  const uint64_t step = (pixels + per_cache - 1) / per_cache;
  std::vector<Walk> walks(per_cache);
  const Walk none;
  LightVertexCache cache;
  for (uint64_t first = 0; first < step; ++first)
    for (uint64_t s = 0; s < spp; ++s) {
      const uint64_t samples = (pixels - first + step - 1) / step;
      const uint64_t walking = caches ? light_walks_of(integrator.mixture, samples) : 0;
      const auto each = [&](uint64_t count, const auto& visit) {
        for (uint64_t i = 0; i < count; ++i) {
          const auto p = static_cast<int>(pixel_of_cache(first, i, step, pixels));
          visit(p % width, p / width, i);
        }
      };
      cache.clear(
          static_cast<uint64_t>(std::lround(counted_samples * static_cast<double>(samples))));
      each(walking, [&](int x, int y, uint64_t i) {
        sampler.begin(x, y, s);
        sampler.light_phase(walks[i]);
        cache.add(walks[i]);
      });
      if (caches && sampler.has_segment_phase())
        each(samples, [&](int x, int y, uint64_t i) {
          sampler.begin(x, y, s);
          sampler.segment_phase(i < walking ? walks[i] : none, cache);
        });
      each(samples, [&](int x, int y, uint64_t i) {
        at(x, y);
        if (!caches) return sample(sampler, x, y, s);
        sampler.begin(x, y, s);
        sampler.camera_phase(i < walking ? walks[i] : none, cache);
        besides(sampler);
        sampler.end();
      });
    }
}

/// Runs only `fewer` of the mixture's techniques.
template <Technique... fewer>
void run_only(PathSampler& sampler) {
  sampler.walk_from_camera();
  sampler.walk_from_light();
  (sampler.run(fewer), ...);
}

/// Runs one of its techniques a second time.
template <Technique again>
void run_twice(PathSampler& sampler) {
  sampler.run();
  sampler.run(again);
}

}  // namespace tdpt
