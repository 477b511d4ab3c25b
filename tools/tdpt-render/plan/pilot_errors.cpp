// What a pilot derives from its samples: errors and work of candidates, its own number of samples,
// and the choice [pilot.h].
#include "tools/tdpt-render/plan/pilot.h"

#include <algorithm>

#include "tools/tdpt-render/plan/work_model.h"

namespace tdpt {
namespace {

constexpr double kDark = 0.01;      // as exrdiff's relMSE
constexpr double kKnown = 0.2;      // relative error below which a mean is well known
constexpr double kMostProduct = 2;  // bound of X X' / I^2: more is chance
// Cost of evaluating paths for all candidates: the sample's own work times this, more if some walks
// are guided.
constexpr double kEvaluating = 1.35, kEvaluatingGuided = 1.8;
constexpr double kLeastLeft = 0.05;   // of M_i: lower bound of V_i
constexpr double kMostMissed = 1e-3;  // share of the light

// Number of pixels in a block, across or down.
int64_t in_part(int64_t part, int64_t parts, int64_t size) {
  const auto first = [&](int64_t p) { return (p * size + parts - 1) / parts; };
  return first(part + 1) - first(part);
}

// Terms of V_i for all candidates, over the squared brightness.
struct Terms {
  explicit Terms(size_t n) : moments(n), correlation(n), product(n) {}
  double variance(size_t i) const { return moments[i] + correlation[i] - product[i]; }
  std::vector<double> moments, correlation, product;
};

Traits traits_of(const Mixture& m) {
  return {m.has(Technique::portal), m.guiding != Guiding{}, !m.techniques.walks_from_light(),
          m.techniques.walks_from_light() && m.light_walks == 1};
}

}  // namespace

// Where the run makes more segments or light walks than the candidate, their work is scaled.
double Pilot::work_of(size_t candidate, bool on_device) const {
  const Mixture& m = candidates_[candidate].integrator.mixture;
  const size_t run = home_[candidate];
  const Mixture& rendered = candidates_[runs_[run]].integrator.mixture;
  const WorkCosts& costs = work_costs(vista_, m, on_device);
  const double of_sample = sample_work(vista_, m, costs, {}, 1);
  const auto work_of_rays = [&](const RayCounts& rays) {
    return sample_work(vista_, m, costs, rays, kGroup * groups()) - of_sample;
  };
  const auto work = [&](size_t part) { return work_of_rays(rays_[run][part]); };
  const double light_walks = m.light_walks / rendered.light_walks;
  double all = of_sample + work(0);
  if (m.techniques.walks_from_light()) all += light_walks * work(1);
  for (size_t t = 0; t < kTechniques; ++t) {
    const auto technique = static_cast<Technique>(t);
    if (!m.has(technique)) continue;
    all += work(3 + t) * (technique == Technique::light ? light_walks : 1);
    if (technique != Technique::portal) continue;
    // Work of the segments, and of considering their pairs with vertices; few pairs get a ray,
    // however many segments there are.
    const double segments = m.segments / rendered.segments;
    RayCounts pairs;
    pairs.connect = rays_[run][3 + t].connect;
    all += work(2) * segments + work_of_rays(pairs) * (segments - 1);
  }
  return all;
}

// Brightness of the picture, by block: the mean of the smallest square of blocks around it for
// which the mean is well known; last that of the whole picture.
std::vector<double> Pilot::block_luminance() const {
  const int width = vista_.view.film.width(), height = vista_.view.film.height();
  const double samples = static_cast<double>(groups()) * kGroup;
  const double of_pixel = samples / (static_cast<double>(width) * static_cast<double>(height));
  double mean = 0;
  for (const double l : sums_[kLuminance]) mean += l / samples;
  std::vector<double> of_block(kBlocks + 1, mean);
  const auto refine = [&](int x0, int y0, int size) {
    double light = 0, squares = 0, pixels = 0;
    const auto each = [&](const auto& visit) {
      for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x) visit(static_cast<size_t>(y * kAcross + x), x, y);
    };
    each([&](size_t b, int x, int y) {
      light += sums_[kLuminance][b], squares += sums_[kSquares][b];
      pixels += static_cast<double>(in_part(x, kAcross, width) * in_part(y, kAcross, height));
    });
    if (!(pixels > 0 && squares < kKnown * kKnown * light * light)) return;
    each([&](size_t b, int, int) { of_block[b] = light / (of_pixel * pixels); });
  };
  for (int size = kAcross / 2; size > 0; size /= 2)
    for (int y = 0; y < kAcross; y += size)
      for (int x = 0; x < kAcross; x += size) refine(x, y, size);
  return of_block;
}

// Sums the terms of V_i / (I^2 + 0.01 mean^2):
//   moments      M_i, of paths in the sample's own pixel, of paths that all sample equally, of
//   splats correlation  X^2 - sum of squares of its paths, each times c product      X X', over all
//   pairs of a group's samples in a run
// The moments are known best. The other terms are clamped to their plausible range: E[X X'] is
// about the squared brightness, by which it is divided.
std::vector<std::vector<double>> Pilot::errors() const {
  const size_t n = candidates_.size(), each = samples_of_group();
  std::vector<std::vector<double>> errors(n, std::vector<double>(kBatches));
  const std::vector<double> of_block = block_luminance();
  const double mean = of_block.back();
  if (!(mean > 0)) return errors;
  const double dark = kDark * mean * mean;
  const auto per_brightness = [&](double block, double pixel) {
    const double I = std::max(block, pixel);
    return 1 / (I * I + dark);
  };
  const auto all = static_cast<double>(kGroup * groups());
  const double of_batch = all / kBatches;
  const double pairs = of_batch * 0.5 * (kGroup - 1);  // each sample with each other
  std::vector<Terms> by_batch(kBatches, Terms(n));
  for (uint64_t k = 0; k < groups(); ++k) {
    Terms& terms = by_batch[k % kBatches];
    const size_t first = k * each;
    const double* const light = &luminance_[first];
    const double block = of_block[blocks_[k]];
    double sum = 0;
    for (size_t j = 0; j < each; ++j) sum += light[j];
    for (size_t a = 0; a < each; ++a) {
      const size_t of_a = (first + a) * n;
      const double others = (sum - light[a]) / static_cast<double>(each - 1);
      const double norm = per_brightness(block, others) / of_batch;
      const double equal =
          equal_[first + a] * per_brightness(block, sum / static_cast<double>(each)) / of_batch;
      for (size_t i = 0; i < n; ++i) {
        terms.moments[i] += equal + moments_[of_a + i] * norm;
        terms.correlation[i] += correlation_[of_a + i] * norm;
      }
      for (size_t b = a + 1; b < each && b / kGroup == a / kGroup; ++b) {
        const size_t of_b = (first + b) * n;
        const double rest = (sum - light[a] - light[b]) / static_cast<double>(each - 2);
        const double of_pair = per_brightness(block, rest);
        for (size_t i = 0; i < n; ++i)
          terms.product[i] += std::min(x_[of_a + i] * x_[of_b + i] * of_pair, kMostProduct) / pairs;
      }
    }
  }
  for (size_t q = 0; q < kBatches; ++q)
    for (size_t i = 0; i < n; ++i) {
      const double* const splats = &sums_[kSplats + i][q * kBlocks];
      for (size_t b = 0; b < kBlocks; ++b)
        by_batch[q].moments[i] += splats[b] / of_batch * per_brightness(of_block[b], 0);
    }
  for (size_t i = 0; i < n; ++i) {
    double moments = 0, variance = 0;
    for (const Terms& t : by_batch) moments += t.moments[i], variance += t.variance(i);
    const bool misses = sums_[kMissed][i] > kMostMissed * mean * all;
    for (size_t q = 0; q < kBatches; ++q)
      errors[i][q] = misses                            ? INFINITY
                     : variance < kLeastLeft * moments ? kLeastLeft * by_batch[q].moments[i]
                                                       : by_batch[q].variance(i);
  }
  return errors;
}

Forecast Pilot::forecast() const {
  const std::vector<std::vector<double>> errors = this->errors();
  std::vector<CandidateEstimate> estimates;
  std::vector<Traits> traits;
  std::vector<std::vector<double>> costs;
  for (size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& c = candidates_[i];
    CandidateEstimate& e = estimates.emplace_back(
        CandidateEstimate{c.label, c.with_portals(), 0, work_of(i, on_device_), 0});
    std::vector<double>& of_batch = costs.emplace_back();
    for (const double error : errors[i]) {
      e.relmse += error / kBatches;
      of_batch.push_back(error * e.work);
    }
    e.cost = e.relmse * e.work;
    traits.push_back(traits_of(c.integrator.mixture));
  }
  return posterior_costs(std::move(estimates), traits, costs, kGroup * groups());
}

double Pilot::work_of_group() const {
  double work = 0;
  for (const size_t r : runs_) work += work_of(r, false);
  return work * kGroup * (runs_.size() > 1 ? kEvaluatingGuided : kEvaluating);
}

bool can_spare(double samples, const Pilot& pilot) {
  return kPilotShare * samples >= static_cast<double>(kFewestGroups * pilot.samples_of_group());
}

uint64_t groups_for_work(double work, const Pilot& pilot) {
  const double groups = std::min(kPilotShare * work / pilot.work_of_group(), 0. + kMostGroups);
  return static_cast<uint64_t>(groups) / Pilot::kBatches * Pilot::kBatches;
}

uint64_t groups_for(double samples, const Pilot& pilot) {
  const Forecast forecast = pilot.forecast();
  return groups_for_work(forecast.estimates[forecast.best].work * samples, pilot);
}

}  // namespace tdpt
