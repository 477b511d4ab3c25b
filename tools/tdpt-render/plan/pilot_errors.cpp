// What a pilot derives from its samples: errors and work of candidates, its own number of samples,
// and the choice [pilot.h].
#include "tools/tdpt-render/plan/pilot.h"

#include <algorithm>
#include <cmath>

#include "tools/tdpt-render/plan/work_model.h"

namespace tdpt {
namespace {

constexpr double kDark = 0.01;    // as exrdiff's relMSE
constexpr double kKnown = 0.2;    // relative error below which a mean is well known
constexpr double kMostAlike = 2;  // bound of X X' / I^2: more is chance
// Cost of evaluating paths for all candidates: the sample's own work times this, more if some walks
// are guided.
constexpr double kLooking = 1.35, kLookingDirected = 1.8;
constexpr double kLeastLeft = 0.05;   // of M_i: lower bound of V_i
constexpr double kMostMissed = 1e-3;  // share of the light

// Number of pixels in a block, across or down.
int64_t in_part(int64_t part, int64_t size) {
  const auto first = [size](int64_t p) {
    return (p * size + PilotSums::kAcross - 1) / PilotSums::kAcross;
  };
  return first(part + 1) - first(part);
}

}  // namespace

// Where the run makes more segments or light walks than the candidate, their work is scaled.
double Pilot::work_of(size_t candidate, const WorkTables& tables) const {
  const Mixture& m = candidates_[candidate].integrator.mixture;
  const size_t run = home_[candidate];
  const Mixture& rendered = candidates_[runs_[run]].integrator.mixture;
  const WorkModel model(vista_, m, tables);
  const auto work_of_rays = [&](const RayCounts& rays) {
    return model.per_sample(rays, kPilotGroup * groups()) - model.per_sample({}, 1);
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
    // Work of the segments, and of considering their pairs with vertices; few pairs get a ray,
    // however many segments there are.
    const double segments = m.segments / rendered.segments;
    RayCounts pairs;
    pairs.connect = sums_.rays[run][3 + t].connect;
    all += work(2) * segments + work_of_rays(pairs) * (segments - 1);
  }
  return all;
}

namespace {

// Brightness of the picture in the smallest blocks for which it is well known.
class Blocks {
 public:
  Blocks(const PilotSums& sums, double groups, int width, int height) {
    constexpr int kAcross = PilotSums::kAcross;
    const double samples = groups * kPilotGroup;
    const double of_pixel = samples / (static_cast<double>(width) * static_cast<double>(height));
    for (const double l : sums.luminance) mean_ += l / samples;
    light_.assign(PilotSums::kBlocks, mean_);
    for (int across = 2; across <= kAcross; across *= 2) {
      const int size = kAcross / across;
      for (int y = 0; y < kAcross; y += size)
        for (int x = 0; x < kAcross; x += size) refine(sums, x, y, size, of_pixel, width, height);
    }
  }

  double mean() const { return mean_; }
  double light(size_t block) const { return light_[block]; }

 private:
  // Uses the mean of a square of blocks if it is well known.
  void refine(const PilotSums& sums, int x0, int y0, int size, double of_pixel, int width,
              int height) {
    double light = 0, squares = 0, pixels = 0;
    const auto each = [&](const auto& visit) {
      for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x)
          visit(static_cast<size_t>(y * PilotSums::kAcross + x),
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

// Terms of V_i for all candidates, over the squared brightness.
struct Terms {
  explicit Terms(size_t n) : moments(n), common(n), apart(n) {}
  double variance(size_t i) const { return moments[i] + common[i] - apart[i]; }
  std::vector<double> moments, common, apart;
};

}  // namespace

// The moments are known best. The other terms are clamped to their plausible range: E[X X'] is
// about the squared brightness, by which it is divided.
std::array<std::vector<double>, PilotSums::kBatches> Pilot::errors() const {
  const size_t n = candidates_.size(), each = samples_of_group();
  std::array<std::vector<double>, PilotSums::kBatches> errors;
  errors.fill(std::vector<double>(n, 0));
  const Blocks blocks(sums_, static_cast<double>(groups()), vista_.view.film.width(),
                      vista_.view.film.height());
  if (!(blocks.mean() > 0)) return errors;
  const double dark = kDark * blocks.mean() * blocks.mean();
  const auto per_brightness = [&](double block, double pixel) {
    const double I = std::max(block, pixel);
    return 1 / (I * I + dark);
  };
  const auto all = static_cast<double>(kPilotGroup * groups());
  const double of_batch = all / PilotSums::kBatches;
  const double pairs =
      of_batch * 0.5 * (kPilotGroup - 1);  // each sample with each other of its group and run
  std::vector<Terms> by_batch(PilotSums::kBatches, Terms(n));
  for (uint64_t k = 0; k < groups(); ++k) {
    Terms& terms = by_batch[k % PilotSums::kBatches];
    const PilotRecord* const of_group = &records_[k * each];
    const double block = blocks.light(blocks_[k]);
    double brought = 0;
    for (size_t j = 0; j < each; ++j) brought += of_group[j].brought;
    for (size_t a = 0; a < each; ++a) {
      const PilotRecord& one = of_group[a];
      const double others = (brought - one.brought) / static_cast<double>(each - 1);
      const double norm = per_brightness(block, others) / of_batch;
      const double alike =
          one.alike * per_brightness(block, brought / static_cast<double>(each)) / of_batch;
      for (size_t i = 0; i < n; ++i) {
        terms.moments[i] += alike + one.moments[i] * norm;
        terms.common[i] += one.common[i] * norm;
      }
      for (size_t b = a + 1; b < each && b / kPilotGroup == a / kPilotGroup; ++b) {
        const PilotRecord& two = of_group[b];
        const double rest = (brought - one.brought - two.brought) / static_cast<double>(each - 2);
        const double of_pair = per_brightness(block, rest);
        for (size_t i = 0; i < n; ++i)
          terms.apart[i] += std::min(one.x[i] * two.x[i] * of_pair, kMostAlike) / pairs;
      }
    }
  }
  for (size_t q = 0; q < PilotSums::kBatches; ++q)
    for (size_t i = 0; i < n; ++i) {
      const double* const splats = &sums_.splats[i][q * PilotSums::kBlocks];
      for (size_t b = 0; b < PilotSums::kBlocks; ++b)
        by_batch[q].moments[i] += splats[b] / of_batch * per_brightness(blocks.light(b), 0);
    }
  for (size_t i = 0; i < n; ++i) {
    double moments = 0, variance = 0;
    for (const Terms& t : by_batch) moments += t.moments[i], variance += t.variance(i);
    const bool misses = sums_.missed[i] > kMostMissed * blocks.mean() * all;
    for (size_t q = 0; q < PilotSums::kBatches; ++q)
      errors[q][i] = misses                            ? INFINITY
                     : variance < kLeastLeft * moments ? kLeastLeft * by_batch[q].moments[i]
                                                       : by_batch[q].variance(i);
  }
  return errors;
}

namespace {

std::array<bool, kTraits> traits(const Vista& vista, const Mixture& m) {
  return {m.has(Technique::portal), m.guiding != Guiding{}, !m.techniques.walks_from_light(),
          !vista.openings.windows.empty() && m.looks_out(),
          m.techniques.walks_from_light() && m.light_walks == 1};
}

}  // namespace

Forecast Pilot::forecast() const {
  const auto errors = this->errors();
  Forecast out;
  std::vector<Evidence> evidence;
  std::vector<size_t> judged;  // their candidates
  for (size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& c = candidates_[i];
    CandidateEstimate p{c.label, c.with_portals(), 0, work_of(i, work_), 0};
    Evidence e{traits(vista_, c.integrator.mixture), {}};
    for (const std::vector<double>& batch : errors) {
      p.relmse += batch[i] / PilotSums::kBatches;
      e.costs.push_back(batch[i] * p.work);
    }
    p.cost = p.relmse * p.work;
    if (std::isfinite(p.cost) && p.cost > 0) {
      evidence.push_back(e);
      judged.push_back(i);
    }
    out.estimates.push_back(p);
  }
  const CostPosterior cost_posterior(evidence);
  std::optional<size_t> best[2];  // of `judged`: without portals, with them
  for (size_t k = 0; k < judged.size(); ++k) {
    CandidateEstimate& p = out.estimates[judged[k]];
    p.cost = cost_posterior.cost(k);
    std::optional<size_t>& rival = best[p.with_portals];
    if (!rival || p.cost < out.estimates[judged[*rival]].cost) rival = k;
  }
  for (const auto& b : best)
    if (b && out.estimates[judged[*b]].cost < out.estimates[out.best].cost) out.best = judged[*b];
  if (best[0] && best[1])
    out.portals = {cost_posterior.ratio(*best[0], *best[1]), judged[*best[1]], judged[*best[0]]};
  return out;
}

double Pilot::work_of_group() const {
  double work = 0;
  for (const size_t r : runs_) work += work_of(r, kCpuWork);
  return work * kPilotGroup * (runs_.size() > 1 ? kLookingDirected : kLooking);
}

bool can_spare(double samples, const Pilot& pilot) {
  return kPilotShare * samples >= static_cast<double>(kFewestGroups * pilot.samples_of_group());
}

uint64_t groups_for_work(double work, const Pilot& pilot) {
  const double groups = std::min(kPilotShare * work / pilot.work_of_group(), 0. + kMostGroups);
  return static_cast<uint64_t>(groups) / PilotSums::kBatches * PilotSums::kBatches;
}

uint64_t groups_for(double samples, const Pilot& pilot) {
  const Forecast forecast = pilot.forecast();
  return groups_for_work(forecast.estimates[forecast.best].work * samples, pilot);
}

}  // namespace tdpt
