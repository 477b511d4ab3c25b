#include "tools/tdpt-render/plan/exploration.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/words.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/streams.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

namespace {

constexpr int kDeepest = 8;  // edges, if no limit of depth asks for longer paths
constexpr size_t kMostPortals = 16;
constexpr uint64_t kLeastSamples = 10, kEnoughLit = 100;
constexpr double kNoLight = 1e-4;  // share of the picture's without its brightest sample
constexpr double kByPower = 0.1;
constexpr double kBrightest = 0.1;  // largest share of the total that one path counts for

// What decides the ways of portals.
constexpr double kLeastEnergy = 0.001;  // share of the picture's light
constexpr double kEarnest = 0.2;        // share of the light through the portal
constexpr double kWideWay = 0.066;      // conductance
// Walks of the probe. The first steps are too near the portal to measure the size of the room.
constexpr uint64_t kWalks = 800;
constexpr int kSteps = 8, kSkipped = 2;

// A portal as working one way, and both.
struct Opening {
  PortalSet front, both;
};

// Luminance that samples carried.
struct Light {
  void add(double sample) { merge({sample > 0, sample, sample}); }
  void merge(const Light& other) {
    samples += other.samples;
    sum += other.sum;
    brightest = std::max(brightest, other.brightest);
  }
  double sure() const { return samples < kLeastSamples ? 0 : sum - brightest; }

  uint64_t samples = 0;  // that carried any
  double sum = 0, brightest = 0;
};

// What the paths of a row of pixels carry; merged, those of all rows.
class Observer {
 public:
  Observer(const std::vector<Opening>& openings, int max_depth)
      : passed(openings.size()),
        either(openings.size()),
        openings_(openings),
        max_depth_(max_depth),
        of_sample_(openings.size()) {}

  // A path of the current sample and its weighted luminance. Directly seen lights are ignored: no
  // selection was needed.
  void see(const Path& path, double light) {
    const bool longer = path.k() > max_depth_;
    by_depth[0][longer] += light;
    if (longer || path.k() < 2) return;
    arrived.push_back({path.vertex(0).source, light});
    all.sum += light;
    sample_ += light;
    for (size_t p = 0; p < openings_.size(); ++p)
      if (pass(path, light, openings_[p], of_sample_[p])) either[p] += light;
  }
  void end_sample() {
    all.merge({sample_ > 0, 0, sample_});
    sample_ = 0;
    for (size_t p = 0; p < openings_.size(); ++p)
      for (size_t way = 0; way < 2; ++way)
        passed[p][way].add(std::exchange(of_sample_[p][way], 0.0));
  }
  void merge(const Observer& other) {
    all.merge(other.all);
    arrived.insert(arrived.end(), other.arrived.begin(), other.arrived.end());
    by_depth.insert(by_depth.end(), other.by_depth.begin(), other.by_depth.end());
    for (size_t p = 0; p < openings_.size(); ++p) {
      either[p] += other.either[p];
      for (size_t way = 0; way < 2; ++way) passed[p][way].merge(other.passed[p][way]);
    }
  }

  Light all;
  std::vector<std::array<Light, 2>> passed;  // by opening: along its normal and against it
  std::vector<double> either;                // either way, each path once
  std::vector<std::pair<const LightSource*, double>> arrived;  // by path
  std::vector<std::array<double, 2>> by_depth{{0, 0}};  // by row: within the depth and beyond

 private:
  static bool pass(const Path& path, double light, const Opening& opening,
                   std::array<double, 2>& ways) {
    bool passes = false;
    for (int i = 0; i + 1 < path.k(); ++i) {
      const Vertex &a = path.vertex(i), &b = path.vertex(i + 1);
      const Vec3d from = a.at_infinity() ? before_the_scene(b.position, a.position) : a.position;
      if (!(opening.both.density(from, b.position) > 0)) continue;
      passes = true;
      if (opening.front.density(from, b.position) > 0) ways[0] += light;
      if (opening.front.density(b.position, from) > 0) ways[1] += light;
    }
    return passes;
  }

  const std::vector<Opening>& openings_;
  int max_depth_;
  double sample_ = 0;  // luminance of the current sample
  std::vector<std::array<double, 2>> of_sample_;
};

// Renders one sample for each pixel of the film.
Observer rendered_small(const Vista& vista, const std::vector<Opening>& openings, int max_depth,
                        uint64_t seed, uint64_t round) {
  const int width = vista.view.film.width(), height = vista.view.film.height();
  // With so few samples each makes its own light walk and draws a segment.
  Mixture mixture = tdpt_guided.mixture;
  mixture.light_walks = mixture.segments = 1;
  const SampleSettings how{mixture, max_depth < kMaxDepth ? kMaxDepth : kDeepest, 1, seed,
                           kExplorationStream};
  Film film(width, height, vista.world->lights.power());
  std::vector<Observer> rows(static_cast<size_t>(height), Observer(openings, max_depth));
  tbb::parallel_for(0, height, [&](int y) {
    Observer& row = rows[static_cast<size_t>(y)];
    const PathObserver observer = [&](const Contribution& found) {
      const double light =
          luminance(found.value) * found.path.weight(mixture, found.strategy, how.beta);
      if (std::isfinite(light)) row.see(found.path, light);
    };
    Tally tally(film.unit());
    PathSampler sampler(vista, how, film, tally, &observer);
    for (int x = 0; x < width; ++x) {
      sampler.sample(x, y, round << 32);  // runs of 2^32 samples of a pixel are independent
      row.end_sample();
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

Lights::KindProbabilities arriving_shares(
    const std::vector<std::pair<const LightSource*, double>>& arrived,
    const Lights::KindProbabilities& by_power) {
  double all = 0, sum = 0;
  for (const auto& [source, light] : arrived) all += light;
  Lights::KindProbabilities by_arrival, shares;
  for (const auto& [source, light] : arrived) {
    const double clamped = std::min(light, kBrightest * all);
    by_arrival.of(*source) += clamped;
    sum += clamped;
  }
  if (!(sum > 0)) return by_power;
  for (double Lights::KindProbabilities::*const kind :
       {&Lights::KindProbabilities::surfaces, &Lights::KindProbabilities::lamps,
        &Lights::KindProbabilities::parallel, &Lights::KindProbabilities::sky})
    shares.*kind = kByPower * by_power.*kind + (1 - kByPower) / sum * by_arrival.*kind;
  return shares;
}

// `by_depth`: light within the depth and beyond, by group of samples.
Truncation truncation_of(const std::vector<std::array<double, 2>>& by_depth, int depth) {
  Truncation result{depth, 0, 0};
  double all = 0, beyond = 0, squares = 0;
  for (const auto& group : by_depth) {
    all += group[0] + group[1];
    beyond += group[1];
  }
  if (!(all > 0)) return result;
  result.share = beyond / all;
  for (const auto& group : by_depth) {
    const double off = group[1] - result.share * (group[0] + group[1]);
    squares += off * off;
  }
  result.error = std::sqrt(squares) / all;
  return result;
}

}  // namespace

Explored explore(const Vista& vista, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples) {
  Explored out;
  out.samples = samples;
  out.ways.resize(portals.size());
  std::vector<size_t> open(std::min(portals.size(), kMostPortals));
  std::iota(open.begin(), open.end(), size_t{0});
  std::vector<bool> dark(portals.size());
  uint64_t lit = 0;  // samples
  std::vector<std::pair<const LightSource*, double>> arrived;
  std::vector<std::array<double, 2>> by_depth;
  Vista small = vista;
  small.view.film = small_film(camera, vista.view.film, samples);
  const Frame& frame = vista.world->scene.frame;
  bool again = !vista.world->lights.empty();
  for (uint64_t round = 0; again; ++round) {
    std::vector<Portal> both;
    std::vector<Opening> openings;
    for (const size_t i : open) {
      both.emplace_back(portals[i]).both_ways = true;
      Portal front = portals[i];
      front.both_ways = false;
      openings.push_back({PortalSet({front}, frame), PortalSet({both.back()}, frame)});
    }
    small.openings.portals = PortalSet(both, frame);
    const Observer seen = rendered_small(small, openings, max_depth, seed, round);
    arrived.insert(arrived.end(), seen.arrived.begin(), seen.arrived.end());
    by_depth.insert(by_depth.end(), seen.by_depth.begin(), seen.by_depth.end());
    again = false;
    if (small.openings.portals.empty()) continue;
    lit = std::max(lit, seen.all.samples);
    std::vector<size_t> silent;
    for (size_t k = 0; k < open.size(); ++k) {
      const size_t i = open[k];
      const auto& [with, against] = seen.passed[k];
      const auto way = [&, &with = with, &against = against](bool wide) {
        return way_of(portals[i].both_ways, {with.sum, against.sum}, {with.sure(), against.sure()},
                      seen.all.sum, wide);
      };
      // Conductance is probed only where it matters.
      out.ways[i] = way(way(true) != way(false) && is_wide(*vista.world, portals[i]));
      dark[i] = seen.either[k] < kNoLight * (seen.all.sum - seen.all.brightest);
      if (std::max(with.samples, against.samples) < kLeastSamples) silent.push_back(i);
    }
    again = round == 0 && !silent.empty() && silent.size() < open.size();
    open = std::move(silent);
  }
  for (size_t i = 0; i < portals.size() && lit >= kEnoughLit; ++i)
    if (dark[i] || std::find(open.begin(), open.end(), i) != open.end())
      out.ways[i] = PortalWay::left_out;
  out.lights = arriving_shares(arrived, vista.openings.selection.shares());
  if (max_depth < kMaxDepth) out.beyond = truncation_of(by_depth, max_depth);
  return out;
}

std::string sentence(const Truncation& beyond) {
  const double most = beyond.share + 2 * beyond.error;
  const std::string depth = fmt::format("--max-depth {} leaves out ", beyond.depth);
  if (beyond.share > 0.995) return depth + "all of the light, or nearly";
  if (most < 0.001) return depth + "less than 0.1 % of the light";
  if (beyond.error > 0.25 * beyond.share)
    return depth + fmt::format("at most about {} of the light", percent_words(most));
  return depth + fmt::format("about {} of the light", percent_words(beyond.share));
}

PortalWay way_of(bool drawn_both_ways, const std::array<double, 2>& passed,
                 const std::array<double, 2>& sure, double total, bool wide) {
  if (!(std::max(sure[0], sure[1]) > kLeastEnergy * total)) return PortalWay::as_drawn;
  const double least = kEarnest * (passed[0] + passed[1]);
  if (sure[1] > least && passed[0] < least) return PortalWay::back;
  if (drawn_both_ways) {
    if (sure[0] > least && passed[1] < least) return PortalWay::front;
    if (wide) return passed[0] < passed[1] ? PortalWay::back : PortalWay::front;
    return PortalWay::as_drawn;
  }
  return sure[1] > least && !wide ? PortalWay::both : PortalWay::as_drawn;
}

double probed_conductance(const World& world, const Portal& portal) {
  Portal one_way = portal;
  one_way.both_ways = false;
  const PortalSet opening({one_way}, world.scene.frame);
  if (opening.empty()) return 0;
  double narrowest = 0;
  for (const uint64_t to_camera : {0, 1}) {
    uint64_t crossed = 0, bounces = 0;
    for (uint64_t i = 0; i < kWalks; ++i) {
      Rng rng(*kPortalProbe.seed, kPortalProbe.first + to_camera, i);
      const PortalSet::SegmentDraw start = opening.sample(rng);
      Tracer::Origin from{start.position};
      Vec3d w = to_camera ? start.direction : -start.direction;
      for (int step = 0; step < kSteps; ++step) {
        Hit hit;
        if (!world.tracer.closest(from, w, hit)) break;
        if (step >= kSkipped) {
          ++bounces;
          const bool crosses = to_camera ? opening.density(hit.position, from.position) > 0
                                         : opening.density(from.position, hit.position) > 0;
          crossed += crosses;
          if (crosses) break;
        }
        const Vec3d n = dot(hit.normal, w) < 0 ? hit.normal : -hit.normal;
        from = {hit.position, n};
        const double u = rng.uniform(), v = rng.uniform();
        w = Onb<double>(n).to_world(cosine_hemisphere(u, v));
      }
    }
    if (bounces > 0)
      narrowest = std::max(narrowest, static_cast<double>(crossed) / static_cast<double>(bounces));
  }
  return narrowest;
}

bool is_wide(const World& world, const Portal& portal) {
  return probed_conductance(world, portal) > kWideWay;
}

void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals) {
  for (size_t i = 0; i < ways.size(); ++i) {
    Portal& portal = portals.at(i);
    if (ways[i] == PortalWay::as_drawn) continue;
    if (ways[i] == PortalWay::left_out) {
      portal.figures.emplace("area", area_of(portal));
      portal.triangles.clear();
      continue;
    }
    portal.both_ways = ways[i] == PortalWay::both;
    if (ways[i] == PortalWay::back)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  }
}

}  // namespace tdpt
