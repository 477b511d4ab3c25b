#include "tools/tdpt-render/render.h"

#include <chrono>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/progress.h"
#include "libcommon/base/signals.h"
#include "libcommon/base/threads.h"

namespace tdpt {
Vec3d RenderResult::mean() const {
  Vec3d sum;
  for (const Rgb& p : picture.pixels) sum += Vec3d(p);
  return sum / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

double RenderResult::nonzero() const {
  size_t n = 0;
  for (const Rgb& p : picture.pixels) n += p != Rgb{};
  return static_cast<double>(n) / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

uint64_t next_frame(uint64_t spp) {
  return spp + std::max<uint64_t>(1, spp < 256 ? 1 : spp / 16);
}

RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings) {
  using Clock = std::chrono::steady_clock;
  const int width = world.film.width(), height = world.film.height();
  const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  SampleSettings sample_settings{integrator.techniques, settings.max_depth, settings.beta,
                                 settings.seed, integrator.stream, integrator.guiding};
  Film film(width, height, world.lights.power(),
            settings.layers ? integrator.techniques : TechniqueSet());
  RenderResult result;
  Progress progress("rendering", "samples", settings.spp * pixels, settings.quiet);
  const auto start = Clock::now();
  const double cpu_start = cpu_seconds();
  // Time spent on measuring frames is no time of rendering.
  double aside = 0, cpu_aside = 0;
  const auto since_start = [&] {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto elapsed = [&] { return since_start() - aside; };
  const auto record_frame = [&] {
    const double seconds = elapsed(), cpu = cpu_seconds();
    const Film::Measure measure = film.measure(result.spp);
    result.frames.push_back(
        {result.spp, measure.nonzero, measure.mean, seconds, cpu - cpu_start - cpu_aside});
    aside = since_start() - seconds;
    cpu_aside += cpu_seconds() - cpu;
  };

  std::vector<Tally> rows(static_cast<size_t>(height));
  // Small pictures take several samples a pass, so that threads have something to share.
  const uint64_t most = std::max<uint64_t>(1, (uint64_t{1} << 16) / pixels);
  uint64_t last_frame = 0;
  while (settings.spp == 0 || result.spp < settings.spp) {
    const uint64_t first = result.spp;
    uint64_t n = settings.spp == 0 ? most : std::min(most, settings.spp - first);
    if (settings.frames) n = std::min(n, next_frame(last_frame) - first);
    tbb::parallel_for(0, height, [&](int y) {
      PathSampler sampler(world, sample_settings, film, rows[static_cast<size_t>(y)]);
      for (int x = 0; x < width; ++x) {
        for (uint64_t s = first; s < first + n; ++s) {
          sampler.begin(x, y, s);
          integrator.sample(sampler);
          sampler.end();
        }
      }
      progress.advance(static_cast<uint64_t>(width) * n);
    });
    result.spp += n;
    if (settings.frames && result.spp == next_frame(last_frame)) {
      record_frame();
      last_frame = result.spp;
    }
    if (stop_requested()) {
      result.interrupted = settings.spp == 0 || result.spp < settings.spp;
      break;
    }
    // Another pass takes about as long as the ones before: stop where the limit is nearest.
    const double per_pass = elapsed() * static_cast<double>(n) / static_cast<double>(result.spp);
    if (settings.seconds > 0 && elapsed() + 0.5 * per_pass > settings.seconds) break;
  }
  if (settings.frames && last_frame < result.spp) record_frame();
  result.seconds = elapsed();
  result.cpu_seconds = cpu_seconds() - cpu_start - cpu_aside;
  for (const Tally& row : rows) result.tally.merge(row);
  result.picture = film.resolve(result.spp);
  for (size_t i = 0; settings.layers && i < kTechniques; ++i)
    if (const auto t = static_cast<Technique>(i); integrator.techniques.has(t))
      result.layers[kTechniqueNames[i]] = film.resolve_layer(t, result.spp);
  return result;
}

}  // namespace tdpt
