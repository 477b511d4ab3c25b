// What a scout tells from its samples: errors and work of candidates, how many samples it may take,
// and the choice [scout.h].
#include "tools/tdpt-render/plan/scout.h"

#include <algorithm>
#include <cmath>

#include "tools/tdpt-render/plan/work_model.h"

namespace tdpt {
namespace {

constexpr double kDark = 0.01;    // as exrdiff's relMSE
constexpr double kKnown = 0.2;    // relative error of what is known well
constexpr double kMostAlike = 2;  // of X X' over I^2: more is chance
// What it costs that all candidates look at a path: so many times the sample, and more where walks
// are directed.
constexpr double kLooking = 1.35, kLookingDirected = 1.8;
constexpr double kLeastLeft = 0.05;   // of M_i, whatever the other terms of V_i take away
constexpr double kMostMissed = 1e-3;  // of the light

// How many pixels lie in one of the parts of the picture, across or down.
int64_t in_part(int64_t part, int64_t size) {
  const auto first = [size](int64_t p) {
    return (p * size + ScoutSums::kAcross - 1) / ScoutSums::kAcross;
  };
  return first(part + 1) - first(part);
}

}  // namespace

// Where the run makes more segments or light walks than the candidate, those count in proportion.
double Scout::work_of(size_t candidate, const WorkTables& tables) const {
  const Mixture& m = candidates_[candidate].integrator.mixture;
  const size_t run = home_[candidate];
  const Mixture& rendered = candidates_[runs_[run]].integrator.mixture;
  const WorkModel model(world_, m, tables);
  const auto work_of_rays = [&](const RayCounts& rays) {
    return model.per_sample(rays, kScoutGroup * groups()) - model.per_sample({}, 1);
  };
  const auto work = [&](size_t part) { return work_of_rays(sums_.rays[run][part]); };
  const double light_walks = m.light_walks / rendered.light_walks;
  double all = model.per_sample({}, 1) + work(0);
  if (m.techniques.walks_from_light()) all += light_walks * work(1);
  for (size_t t = 0; t < kTechniques; ++t) {
    const auto technique = static_cast<Technique>(t);
    if (!m.has(technique)) continue;
    all += work(3 + t) * (technique == Technique::light ? light_walks : 1);
    if (technique != Technique::portal) continue;
    // The segments, and the pairs of them and vertices, few of which get their ray whatever.
    const double segments = m.segments / rendered.segments;
    RayCounts pairs;
    pairs.join = sums_.rays[run][3 + t].join;
    all += work(2) * segments + work_of_rays(pairs) * (segments - 1);
  }
  return all;
}

namespace {

// Brightness of the picture in blocks, each as small as it is known well.
class Blocks {
 public:
  Blocks(const ScoutSums& sums, double groups, int width, int height) {
    constexpr int kAcross = ScoutSums::kAcross;
    const double samples = groups * kScoutGroup;
    const double of_pixel = samples / (static_cast<double>(width) * static_cast<double>(height));
    for (const double l : sums.luminance) mean_ += l / samples;
    light_.assign(ScoutSums::kBlocks, mean_);
    for (int across = 2; across <= kAcross; across *= 2) {
      const int size = kAcross / across;
      for (int y = 0; y < kAcross; y += size)
        for (int x = 0; x < kAcross; x += size) refine(sums, x, y, size, of_pixel, width, height);
    }
  }

  double mean() const { return mean_; }
  double light(size_t block) const { return light_[block]; }

 private:
  // Takes the mean of a square of blocks where that is known.
  void refine(const ScoutSums& sums, int x0, int y0, int size, double of_pixel, int width,
              int height) {
    double light = 0, squares = 0, pixels = 0;
    const auto each = [&](const auto& visit) {
      for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x)
          visit(static_cast<size_t>(y * ScoutSums::kAcross + x),
                static_cast<double>(in_part(x, width) * in_part(y, height)));
    };
    each([&](size_t b, double in) {
      light += sums.luminance[b], squares += sums.squares[b], pixels += in;
    });
    if (!(pixels > 0 && squares < kKnown * kKnown * light * light)) return;
    each([&](size_t b, double) { light_[b] = light / (of_pixel * pixels); });
  }

  std::vector<double> light_;  // by block
  double mean_ = 0;
};

// Terms of V_i, of all candidates, over the square of the brightness.
struct Terms {
  explicit Terms(size_t n) : moments(n), common(n), apart(n) {}
  double variance(size_t i) const {
    return std::max(moments[i] + common[i] - apart[i], kLeastLeft * moments[i]);
  }
  std::vector<double> moments, common, apart;
};

}  // namespace

// The moments are known best. The other terms are held within what they can be: E[X X'] is about
// the squared brightness, which it is divided by.
std::array<std::vector<double>, ScoutSums::kQuarters> Scout::errors() const {
  const size_t n = candidates_.size(), each = samples_of_group();
  std::array<std::vector<double>, ScoutSums::kQuarters> errors;
  errors.fill(std::vector<double>(n, 0));
  const Blocks blocks(sums_, static_cast<double>(groups()), world_.film.width(),
                      world_.film.height());
  if (!(blocks.mean() > 0)) return errors;
  const double dark = kDark * blocks.mean() * blocks.mean();
  const auto per_brightness = [&](double block, double pixel) {
    const double I = std::max(block, pixel);
    return 1 / (I * I + dark);
  };
  const auto all = static_cast<double>(kScoutGroup * groups());
  const double of_quarter = all / ScoutSums::kQuarters;
  const double pairs =
      of_quarter * 0.5 * (kScoutGroup - 1);  // each sample with each other of its run
  std::array<Terms, ScoutSums::kQuarters> by_quarter{Terms(n), Terms(n), Terms(n), Terms(n)};
  for (uint64_t k = 0; k < groups(); ++k) {
    Terms& terms = by_quarter[k % ScoutSums::kQuarters];
    const ScoutRecord* const of_group = &records_[k * each];
    const double block = blocks.light(blocks_[k]);
    double brought = 0;
    for (size_t j = 0; j < each; ++j) brought += of_group[j].brought;
    for (size_t a = 0; a < each; ++a) {
      const ScoutRecord& one = of_group[a];
      const double others = (brought - one.brought) / static_cast<double>(each - 1);
      const double norm = per_brightness(block, others) / of_quarter;
      const double alike =
          one.alike * per_brightness(block, brought / static_cast<double>(each)) / of_quarter;
      for (size_t i = 0; i < n; ++i) {
        terms.moments[i] += alike + one.moments[i] * norm;
        terms.common[i] += one.common[i] * norm;
      }
      for (size_t b = a + 1; b < each && b / kScoutGroup == a / kScoutGroup; ++b) {
        const ScoutRecord& two = of_group[b];
        const double rest = (brought - one.brought - two.brought) / static_cast<double>(each - 2);
        const double of_pair = per_brightness(block, rest);
        for (size_t i = 0; i < n; ++i)
          terms.apart[i] += std::min(one.x[i] * two.x[i] * of_pair, kMostAlike) / pairs;
      }
    }
  }
  for (size_t q = 0; q < ScoutSums::kQuarters; ++q)
    for (size_t i = 0; i < n; ++i) {
      const double* const splats = &sums_.splats[i][q * ScoutSums::kBlocks];
      for (size_t b = 0; b < ScoutSums::kBlocks; ++b)
        by_quarter[q].moments[i] += splats[b] / of_quarter * per_brightness(blocks.light(b), 0);
      const bool misses = sums_.missed[i] > kMostMissed * blocks.mean() * all;
      errors[q][i] = misses ? INFINITY : by_quarter[q].variance(i);
    }
  return errors;
}

std::vector<Prospect> Scout::prospects() const {
  const auto errors = this->errors();
  std::vector<Prospect> all;
  for (size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& c = candidates_[i];
    const bool safe = c.label == bdpt.name || c.label == nee.name;
    Prospect p{c.label, c.with_portals(), safe, 0, 0, work_of(i, work_)};
    double logarithm = 0;
    for (const std::vector<double>& quarter : errors) {
      p.relmse += quarter[i] / ScoutSums::kQuarters;
      logarithm += std::log(quarter[i]) / ScoutSums::kQuarters;
    }
    p.steady = std::exp(logarithm);
    all.push_back(p);
  }
  return all;
}

double Scout::work_of_group() const {
  double work = 0;
  for (const size_t r : runs_) work += work_of(r, kCpuWork);
  return work * kScoutGroup * (runs_.size() > 1 ? kLookingDirected : kLooking);
}

double scouts_share(double spp) {
  return std::clamp(0.06 * std::cbrt(8 / spp), 0.01, 0.06);
}

bool can_spare(double spp, uint64_t pixels, const Scout& scout) {
  return scouts_share(spp) * spp * static_cast<double>(pixels) >=
         static_cast<double>(kFewestGroups * scout.samples_of_group());
}

uint64_t groups_for(double spp, uint64_t pixels, const Scout& scout) {
  const std::vector<Prospect> told = scout.prospects();
  // The work of what may turn out to be the best.
  const double least = told[best_of(told, scout.groups(), spp)].cost();
  const double perhaps = 1 + 8 / std::sqrt(static_cast<double>(scout.groups()));
  double work = 0;
  for (const Prospect& p : told)
    if (p.cost() <= perhaps * least) work = std::max(work, p.work);
  work *= spp * static_cast<double>(pixels);
  return static_cast<uint64_t>(
      std::min(scouts_share(spp) * work / scout.work_of_group(), static_cast<double>(kMostGroups)));
}

double left_to_nee(double relmse, double spp) {
  const double how_many = std::clamp(std::log2(spp / 8) / 2, 0.0, 1.0);
  return 1 - how_many * (0.1 + 0.35 / (1 + relmse * relmse));
}

size_t best_of(const std::vector<Prospect>& prospects, uint64_t groups, double spp) {
  // What chance does to the ratio of two candidates that are told from the same paths.
  const double better = 1 - 1 / std::sqrt(static_cast<double>(std::max<uint64_t>(groups, 4)));
  const auto cost = [&](const Prospect& p) {
    const double left = p.integrator.starts_with(nee.name) ? left_to_nee(p.relmse, spp) : 1;
    return left * p.cost() / (p.safe ? 1 : better);
  };
  size_t best = 0;
  for (size_t i = 1; i < prospects.size(); ++i)
    if (cost(prospects[i]) < cost(prospects[best])) best = i;
  return best;
}

std::optional<size_t> best_with(bool portals, const std::vector<Prospect>& prospects) {
  std::optional<size_t> best;
  for (size_t i = 0; i < prospects.size(); ++i)
    if (prospects[i].with_portals == portals &&
        (!best || prospects[i].cost() < prospects[*best].cost()))
      best = i;
  return best;
}

}  // namespace tdpt
