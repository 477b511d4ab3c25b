#include "tools/tdpt-render/plan/portal_ways.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"
#include "tools/tdpt-render/plan/portal_probe.h"

namespace tdpt {
namespace {

constexpr size_t kMostPortals = 16;
constexpr int kDeepest = 8;
constexpr uint64_t kLeastSamples = 10;
constexpr double kLeastEnergy = 0.001;  // of the picture's
constexpr double kEarnest = 0.2;        // of what passes the portal
constexpr double kWideWay = 0.066;      // conductance
constexpr double kNoLight = 1e-4;       // of the picture's but for its brightest sample
constexpr uint64_t kEnoughLit = 100;    // samples

/// With the normal and against it.
using BothWays = std::array<PassedLight, 2>;

struct Passed {
  std::vector<BothWays> portals;
  std::vector<PortalLight> either;  // way, each path once; `share`: the sum of it
  double total = 0, brightest = 0;  // of all samples; the most that one brought
  uint64_t lit = 0;                 // samples
};

// Adds up what the paths of one row of the picture carry through each portal.
class Counter {
 public:
  Counter(const std::vector<PortalSet>& portals, const Mixture& mixture)
      : portals_(portals),
        mixture_(mixture),
        passed_{std::vector<BothWays>(portals.size()), std::vector<PortalLight>(portals.size())},
        of_sample_(portals.size()) {}

  void add(const Contribution& found) {
    const Path& path = found.path;
    if (path.k() < 2) return;  // a lamp, or the sky, seen directly
    const double light = luminance(found.value) * path.weight(mixture_, found.strategy, 1);
    if (!std::isfinite(light)) return;
    passed_.total += light;
    sample_ += light;
    for (size_t p = 0; p < portals_.size(); ++p) {
      bool passes = false;
      for (int i = 0; i + 1 < path.k(); ++i) {
        const Vertex &a = path.vertex(i), &b = path.vertex(i + 1);
        const Vec3d from = a.at_infinity() ? before_the_scene(b.position, a.position) : a.position;
        const bool with = portals_[p].density(from, b.position) > 0;
        const bool against = portals_[p].density(b.position, from) > 0;
        if (with) of_sample_[p][0] += light;
        if (against) of_sample_[p][1] += light;
        passes |= with || against;
      }
      if (passes) passed_.either[p].share += light;
    }
  }
  void end_sample() {
    passed_.lit += sample_ > 0;
    passed_.brightest = std::max(passed_.brightest, sample_);
    sample_ = 0;
    for (size_t p = 0; p < portals_.size(); ++p) {
      ++passed_.either[p].of;
      passed_.either[p].samples += of_sample_[p][0] > 0 || of_sample_[p][1] > 0;
      for (size_t way = 0; way < 2; ++way) {
        double& light = of_sample_[p][way];
        PassedLight& sum = passed_.portals[p][way];
        sum.samples += light > 0;
        sum.energy += light;
        sum.brightest = std::max(sum.brightest, light);
        light = 0;
      }
    }
  }
  const Passed& passed() const { return passed_; }

 private:
  const std::vector<PortalSet>& portals_;
  Mixture mixture_;
  Passed passed_;
  std::vector<std::array<double, 2>> of_sample_;
  double sample_ = 0;  // what it brought
};

// One sample of each pixel, with the portals of `world`.
Passed passed_light(const World& world, const std::vector<Portal>& portals, int max_depth,
                    uint64_t seed) {
  std::vector<PortalSet> fronts;
  for (Portal portal : portals) {
    portal.both_ways = false;
    fronts.emplace_back(std::vector{portal}, world.scene.frame);
  }
  const int width = world.film.width(), height = world.film.height();
  // Its samples are few: each makes a light walk and draws a segment.
  Mixture mixture = tdpt_guided.mixture;
  mixture.light_walks = mixture.segments = 1;
  Film film(width, height, world.lights.power());
  std::vector<Tally> tallies(static_cast<size_t>(height), Tally(film.unit()));
  std::vector<Counter> rows(static_cast<size_t>(height), Counter(fronts, mixture));
  tbb::parallel_for(0, height, [&](int y) {
    Counter& row = rows[static_cast<size_t>(y)];
    const PathObserver observer = [&](const Contribution& found) { row.add(found); };
    PathSampler sampler(world, {mixture, max_depth, 1, seed, kPortalWaysStream}, film,
                        tallies[static_cast<size_t>(y)], &observer);
    for (int x = 0; x < width; ++x) {
      sampler.sample(x, y, 0);
      row.end_sample();
    }
  });
  Passed all{std::vector<BothWays>(portals.size()), std::vector<PortalLight>(portals.size())};
  for (const Counter& row : rows) {
    all.total += row.passed().total;
    all.lit += row.passed().lit;
    all.brightest = std::max(all.brightest, row.passed().brightest);
    for (size_t p = 0; p < portals.size(); ++p) {
      const PortalLight& either = row.passed().either[p];
      all.either[p].samples += either.samples;
      all.either[p].of += either.of;
      all.either[p].share += either.share;
      for (size_t way = 0; way < 2; ++way) {
        PassedLight& sum = all.portals[p][way];
        const PassedLight& part = row.passed().portals[p][way];
        sum.samples += part.samples;
        sum.energy += part.energy;
        sum.brightest = std::max(sum.brightest, part.brightest);
      }
    }
  }
  return all;
}

FilmPlane small_film(const Camera& camera, const FilmPlane& film, double pixels) {
  const double aspect = static_cast<double>(film.width()) / film.height();
  const auto size = [pixels](double v) {
    return static_cast<int>(std::clamp(std::round(v), 1.0, pixels));
  };
  const int height = size(std::sqrt(pixels / aspect));
  return FilmPlane(camera, size(pixels / height), height);
}

// A world that is to have another film and other portals for a while.
class Lent {
 public:
  Lent(World& world, FilmPlane film) : world_(world), film_(world.film), drawn_(world.portals) {
    world.film = film;
  }
  ~Lent() {
    world_.film = film_;
    world_.fill_openings(std::move(drawn_));
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

 private:
  World& world_;
  const FilmPlane film_;
  PortalSet drawn_;
};

bool tells(const BothWays& light) {
  return std::max(light[0].samples, light[1].samples) >= kLeastSamples;
}

}  // namespace

PortalWay::Way way_of(bool drawn_both_ways, const PassedLight& with, const PassedLight& against,
                      double total, bool wide) {
  const auto sure = [](const PassedLight& light) {
    return light.samples < kLeastSamples ? 0 : light.energy - light.brightest;
  };
  if (!(std::max(sure(with), sure(against)) > kLeastEnergy * total)) return PortalWay::as_drawn;
  const double least = kEarnest * (with.energy + against.energy);
  if (sure(against) > least && with.energy < least) return PortalWay::back;
  if (drawn_both_ways) {
    if (sure(with) > least && against.energy < least) return PortalWay::front;
    if (wide) return with.energy < against.energy ? PortalWay::back : PortalWay::front;
    return PortalWay::as_drawn;
  }
  return sure(against) > least && !wide ? PortalWay::both : PortalWay::as_drawn;
}

PortalProbe probe_ways(World& world, const Camera& camera, const std::vector<Portal>& portals,
                       int max_depth, uint64_t seed, double samples) {
  PortalProbe probe{std::vector<PortalWay>(portals.size()),
                    std::vector<PortalLight>(portals.size())};
  for (size_t i = 0; i < portals.size(); ++i) probe.ways[i].portal = i;
  std::vector<size_t> open(std::min(portals.size(), kMostPortals));
  for (size_t i = 0; i < open.size(); ++i) open[i] = i;
  const Lent lent(world, small_film(camera, world.film, samples));
  uint64_t lit = 0;
  std::vector<bool> dark(portals.size());
  // First all of them. Small ones beside large ones may get next to no segments: a second picture
  // is theirs alone.
  for (int round = 0; round < 2 && !open.empty() && !world.lights.empty(); ++round) {
    std::vector<Portal> probed;
    for (const size_t i : open) {
      probed.push_back(portals[i]);
      probed.back().both_ways = true;
    }
    world.fill_openings(PortalSet(probed, world.scene.frame));
    if (world.portals.empty()) break;
    const Passed light = passed_light(world, probed, std::min(max_depth, kDeepest), seed);
    lit = std::max(lit, light.lit);
    std::vector<size_t> silent;
    for (size_t k = 0; k < open.size(); ++k) {
      const BothWays& of_portal = light.portals[k];
      const Portal& portal = portals[open[k]];
      const auto way = [&](bool wide) {
        return way_of(portal.both_ways, of_portal[0], of_portal[1], light.total, wide);
      };
      // Whether it is wide is asked only where it matters.
      probe.ways[open[k]].way =
          way(true) != way(false) && probed_conductance(world, portal) > kWideWay ? way(true)
                                                                                  : way(false);
      PortalLight& found = probe.light[open[k]] = light.either[k];
      dark[open[k]] = found.share < kNoLight * (light.total - light.brightest);
      if (light.total > 0) found.share /= light.total;
      if (!tells(of_portal)) silent.push_back(open[k]);
    }
    const bool all_silent = silent.size() == open.size();
    open = std::move(silent);
    if (all_silent) break;
  }
  if (lit >= kEnoughLit)
    for (size_t i = 0; i < portals.size(); ++i)
      if (dark[i] || std::find(open.begin(), open.end(), i) != open.end())
        probe.ways[i].way = PortalWay::left_out;
  return probe;
}

void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals) {
  for (const PortalWay& w : ways) {
    Portal& portal = portals.at(w.portal);
    if (w.way == PortalWay::as_drawn) continue;
    if (w.way == PortalWay::left_out) {
      portal.figures.emplace("area", area_of(portal));
      portal.triangles.clear();
      continue;
    }
    portal.both_ways = w.way == PortalWay::both;
    if (w.way == PortalWay::back)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  }
}

}  // namespace tdpt
