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

// Renders one sample for each pixel of the world's film.
Observers look(const World& world, const std::vector<PassedPortals::Opening>& openings,
               int max_depth, uint64_t seed, uint64_t round) {
  const int width = world.film.width(), height = world.film.height();
  // With so few samples each makes its own light walk and draws a segment.
  Mixture mixture = tdpt_guided.mixture;
  mixture.light_walks = mixture.segments = 1;
  const SampleSettings how{mixture, max_depth < kMaxDepth ? kMaxDepth : kDeepest, 1, seed,
                           kExplorationStream};
  Film film(width, height, world.lights.power());
  std::vector<Observers> rows(static_cast<size_t>(height), Observers(openings, max_depth));
  tbb::parallel_for(0, height, [&](int y) {
    Observers& row = rows[static_cast<size_t>(y)];
    const PathObserver observer = [&](const Contribution& found) {
      const double light =
          luminance(found.value) * found.path.weight(mixture, found.strategy, how.beta);
      if (std::isfinite(light)) row.see(found.path, light);
    };
    Tally tally(film.unit());
    PathSampler sampler(world, how, film, tally, &observer);
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

// Swaps the world's film and restores film and portals at the end of the scope. Next events towards
// the sky stay as they were.
class Lent {
 public:
  Lent(World& world, FilmPlane film) : world_(world), film_(world.film), drawn_(world.portals) {
    world.film = film;
  }
  ~Lent() {
    world_.film = film_;
    world_.portals = std::move(drawn_);
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

 private:
  World& world_;
  const FilmPlane film_;
  PortalSet drawn_;
};

}  // namespace

Explored explore(World& world, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples) {
  Explored out;
  WayFinder finder(portals);
  ArrivingLight arriving;
  LightByDepth by_depth(max_depth);
  {
    const Lent lent(world, small_film(camera, world.film, samples));
    for (uint64_t round = 0; !world.lights.empty() && finder.asks(round); ++round) {
      const std::vector<Portal> open = finder.opened();
      const std::vector<PassedPortals::Opening> openings =
          PassedPortals::openings(open, world.scene.frame);
      world.portals = PortalSet(open, world.scene.frame);
      const Observers seen = look(world, openings, max_depth, seed, round);
      finder.learn(seen.passed, world);
      arriving.merge(seen.arriving);
      by_depth.merge(seen.by_depth);
      out.samples += static_cast<uint64_t>(world.film.width() * world.film.height());
    }
  }
  out.ways = finder.told();
  out.lights = arriving.shares(world.lights.shares());
  if (max_depth < kMaxDepth) out.beyond = by_depth.beyond();
  return out;
}

}  // namespace tdpt
