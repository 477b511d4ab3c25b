#include "tools/tdpt-render/plan/exploration.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {
namespace {

constexpr int kDeepest = 8;  // edges, if no limit of depth asks for longer paths

struct Observers {
  Observers(const std::vector<PassedPortals::Opening>& openings, int depth)
      : passed(openings), by_depth(depth), max_depth(depth) {}
  void see(const Path& path, double light) {
    by_depth.see(path, light);
    if (path.k() > max_depth) return;
    passed.see(path, light);
    arriving.see(path, light);
  }
  void merge(const Observers& other) {
    passed.merge(other.passed);
    arriving.merge(other.arriving);
    by_depth.merge(other.by_depth);
  }

  PassedPortals passed;
  ArrivingLight arriving;
  LightByDepth by_depth;
  int max_depth;
};

// Renders one sample for each pixel of the film.
Observers look(const Vista& vista, const std::vector<PassedPortals::Opening>& openings,
               int max_depth, uint64_t seed, uint64_t round) {
  const int width = vista.view.film.width(), height = vista.view.film.height();
  // With so few samples each makes its own light walk and draws a segment.
  Mixture mixture = tdpt_guided.mixture;
  mixture.light_walks = mixture.segments = 1;
  const SampleSettings how{mixture, max_depth < kMaxDepth ? kMaxDepth : kDeepest, 1, seed,
                           kExplorationStream};
  Film film(width, height, vista.world->lights.power());
  std::vector<Observers> rows(static_cast<size_t>(height), Observers(openings, max_depth));
  tbb::parallel_for(0, height, [&](int y) {
    Observers& row = rows[static_cast<size_t>(y)];
    const PathObserver observer = [&](const Contribution& found) {
      const double light =
          luminance(found.value) * found.path.weight(mixture, found.strategy, how.beta);
      if (std::isfinite(light)) row.see(found.path, light);
    };
    Tally tally(film.unit());
    PathSampler sampler(vista, how, film, tally, &observer);
    for (int x = 0; x < width; ++x) {
      sampler.sample(x, y, round << 32);  // runs of 2^32 samples of a pixel are independent
      row.passed.end_sample();
    }
  });
  for (size_t y = 1; y < rows.size(); ++y) rows[0].merge(rows[y]);
  return std::move(rows[0]);
}

FilmPlane small_film(const Camera& camera, const FilmPlane& film, double pixels) {
  const double aspect = static_cast<double>(film.width()) / film.height();
  const auto size = [pixels](double v) {
    return static_cast<int>(std::clamp(std::round(v), 1.0, pixels));
  };
  const int height = size(std::sqrt(pixels / aspect));
  return FilmPlane(camera, size(pixels / height), height);
}

}  // namespace

Explored explore(const Vista& vista, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples) {
  Explored out;
  WayFinder finder(portals);
  ArrivingLight arriving;
  LightByDepth by_depth(max_depth);
  Vista small = vista;
  small.view.film = small_film(camera, vista.view.film, samples);
  for (uint64_t round = 0; !vista.world->lights.empty() && finder.asks(round); ++round) {
    const std::vector<Portal> open = finder.opened();
    const Frame& frame = vista.world->scene.frame;
    const std::vector<PassedPortals::Opening> openings = PassedPortals::openings(open, frame);
    small.openings.portals = PortalSet(open, frame);
    const Observers seen = look(small, openings, max_depth, seed, round);
    finder.learn(seen.passed, small);
    arriving.merge(seen.arriving);
    by_depth.merge(seen.by_depth);
    out.samples += small.view.film.pixels();
  }
  out.ways = finder.told();
  out.lights = arriving.shares(vista.openings.selection.shares());
  if (max_depth < kMaxDepth) out.beyond = by_depth.beyond();
  return out;
}

}  // namespace tdpt
