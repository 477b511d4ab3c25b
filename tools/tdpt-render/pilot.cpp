// The pilot of `auto`: its candidates and its plan, the errors of candidates from pairs of passes,
// and the choice [pilot.h].
#include "tools/tdpt-render/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libcommon/formats/portal_worth.h"

namespace tdpt {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// exrdiff's: errors of pixels darker than a tenth of the picture's mean count less.
constexpr double kDark = 0.01;
constexpr double kSurely = 3;  // standard errors
// Blocks across and down the picture: those whose means normalise, and those that are asked whether
// a candidate misses light. The latter are large: in a small one the rim of a lamp may be all that
// is bright, met by one candidate and not by the other.
constexpr int kFine = 16;
constexpr std::array kCoarse{4, 1};
// One pixel in so many, one at least, counts no more than the brightest of the others: a single
// bright sample in a few passes tells of luck. Where an integrator has many, they are still
// counted.
constexpr size_t kLucky = 5000;

// Without luck.
double calm_mean(const std::vector<float>& values) {
  std::vector<float> sorted = values;
  const size_t lucky = (values.size() + kLucky - 1) / kLucky;
  const auto most = sorted.end() - static_cast<std::ptrdiff_t>(std::min(lucky + 1, sorted.size()));
  std::nth_element(sorted.begin(), most, sorted.end());
  double sum = 0;
  for (float v : values) sum += std::min(v, *most);
  return sum / static_cast<double>(values.size());
}

}  // namespace

bool all_useless(const std::vector<Portal>& portals) {
  return std::all_of(portals.begin(), portals.end(),
                     [](const Portal& p) { return verdict_of(p.figures).worth == Worth::useless; });
}

std::vector<Candidate> auto_candidates(const World& world, const std::vector<Portal>& portals,
                                       std::span<const Integrator> guided) {
  std::vector<Integrator> order;
  if (world.portals.empty())
    order = {tdpt_guided, nee, bdpt, pt};  // the first: bdpt with next events favoured
  else if (all_useless(portals))
    order = {bdpt, guided[0], nee, tdpt_org};
  else
    order = {guided[0], bdpt, nee, tdpt_org};
  if (!world.portals.empty()) order.insert(order.end(), guided.begin() + 1, guided.end());
  std::vector<Candidate> candidates;
  for (const Integrator& integrator : order)
    if (light_missed(integrator, world.scene).empty())
      candidates.push_back({integrator, label_of(integrator)});
  return candidates;
}

Integrator either_of(const std::vector<Candidate>& candidates) {
  Integrator any = candidates.front().integrator;
  any.name = "auto";
  TechniqueSet& all = any.mixture.techniques;
  for (const Candidate& c : candidates) all = all | c.integrator.mixture.techniques;
  return any;
}

PilotPlan plan_pilot(double spp, uint64_t pixels, size_t candidates, bool exact) {
  const double least = std::max(2.0, std::ceil(kLeastSamples / (2 * static_cast<double>(pixels))));
  PilotPlan plan;
  plan.candidates =
      static_cast<size_t>(std::min(static_cast<double>(candidates), spp / 4 / (2 * least)));
  if (plan.candidates < 2) return {};
  const double passes = 2 * static_cast<double>(plan.candidates);
  plan.rounds = static_cast<uint64_t>(std::clamp(spp / 16 / passes, least, std::max(least, 8.0)));
  // Each round counts as the two samples that the chosen one would have taken instead. Where the
  // time is what ends the rendering, another than the first candidate may get further in it.
  plan.kept = 2 * static_cast<double>(plan.rounds) / (exact ? spp : 2 * spp);
  return plan;
}

PilotErrors::PilotErrors(int width, int height, size_t candidates)
    : width_(width), height_(height), candidates_(candidates) {}

void PilotErrors::add_round(size_t candidate, const std::vector<Vec3d>& first,
                            const std::vector<Vec3d>& second) {
  OfCandidate& c = candidates_[candidate];
  if (c.rounds++ == 0) {
    c.sum.resize(first.size());
    c.square.resize(first.size());
  }
  for (size_t i = 0; i < first.size(); ++i) {
    const double x = luminance(Vec3f(first[i])), y = luminance(Vec3f(second[i]));
    c.sum[i] += static_cast<float>(x + y);
    c.square[i] += static_cast<float>(0.5 * (x - y) * (x - y));
  }
}

// Mean and variance of a sample in blocks of pixels, for each candidate with rounds.
struct PilotErrors::Grid {
  Grid(const PilotErrors& errors, int across_)
      : across(across_),
        width(errors.width_),
        height(errors.height_),
        pixels(static_cast<size_t>(across * across)) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) ++pixels[block_of(x, y)];
    for (const OfCandidate& c : errors.candidates_) {
      std::vector<double>& m = mean.emplace_back(pixels.size());
      std::vector<double>& v = variance.emplace_back(pixels.size());
      rounds.push_back(static_cast<double>(c.rounds));
      if (c.rounds == 0) continue;
      size_t i = 0;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, ++i) {
          m[block_of(x, y)] += c.sum[i];
          v[block_of(x, y)] += c.square[i];
        }
      for (size_t b = 0; b < pixels.size(); ++b) {
        m[b] /= std::max(samples(rounds.size() - 1, b), 1.0);
        v[b] /= std::max(samples(rounds.size() - 1, b) / 2, 1.0);
      }
    }
  }

  size_t block_of(int x, int y) const {
    return static_cast<size_t>(int64_t{y} * across / height * across + int64_t{x} * across / width);
  }
  double samples(size_t candidate, size_t b) const { return 2 * pixels[b] * rounds[candidate]; }
  // Standard error of the mean.
  double error(size_t candidate, size_t b) const {
    return std::sqrt(variance[candidate][b] / samples(candidate, b));
  }
  // Weighed over candidates.
  double picture(const std::vector<double>& weights, size_t b) const {
    double sum = 0;
    for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * mean[i][b];
    return sum;
  }
  // Relative variance of a sample that comes of the light that a candidate misses.
  std::vector<double> missed(const std::vector<double>& weights, double dark) const {
    std::vector<double> out(weights.size());
    const double all = static_cast<double>(width) * height;
    for (size_t b = 0; b < pixels.size(); ++b) {
      if (!(pixels[b] > 0)) continue;
      const double m = picture(weights, b);
      for (size_t i = 0; i < out.size(); ++i) {
        if (!(rounds[i] > 0)) continue;
        double missing = 0;
        for (size_t j = 0; j < out.size(); ++j)
          if (rounds[j] > 0)
            missing = std::max(
                missing, mean[j][b] - mean[i][b] - kSurely * std::hypot(error(i, b), error(j, b)));
        out[i] += pixels[b] / all * samples(i, b) * missing * missing / (m * m + dark);
      }
    }
    return out;
  }

  int across, width, height;
  std::vector<double> pixels, rounds;
  std::vector<std::vector<double>> mean, variance;  // [candidate][block]
};

std::vector<double> PilotErrors::relmse() const {
  const size_t n = candidates_.size();
  std::vector<bool> out(n);
  for (size_t i = 0; i < n; ++i) out[i] = candidates_[i].rounds == 0;
  std::vector<double> error(n, kInfinite);
  if (std::all_of(out.begin(), out.end(), [](bool o) { return o; })) return error;
  const Grid fine(*this, kFine);
  std::vector<Grid> coarse;
  for (int across : kCoarse) coarse.emplace_back(*this, across);
  const size_t pixels = static_cast<size_t>(width_) * static_cast<size_t>(height_);

  // The normaliser needs weights and the weights a normaliser.
  std::vector<double> weights = pilot_weights(std::vector<double>(n, 1), out);
  for (int turn = 0; turn < 3; ++turn) {
    const double m = coarse.back().picture(weights, 0);
    if (!(m > 0)) return std::vector<double>(n, 0);
    const double dark = kDark * m * m;
    std::vector<std::vector<float>> scatter(n);  // by pixel
    std::vector<double> missed(n), in_block;
    for (size_t i = 0; i < n; ++i)
      if (!out[i]) scatter[i].resize(pixels);
    for (size_t b = 0; b < fine.pixels.size(); ++b) in_block.push_back(fine.picture(weights, b));
    size_t k = 0;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x, ++k) {
        const double block = in_block[fine.block_of(x, y)];
        double here = 0;  // weighed
        for (size_t i = 0; i < n; ++i)
          if (weights[i] > 0) here += weights[i] * candidates_[i].sum[k] / (2 * fine.rounds[i]);
        for (size_t i = 0; i < n; ++i) {
          if (out[i]) continue;
          const double own = weights[i] * candidates_[i].sum[k] / (2 * fine.rounds[i]);
          const double others = weights[i] < 1 ? (here - own) / (1 - weights[i]) : 0;
          const double norm = std::max(block, others);
          scatter[i][k] = static_cast<float>(candidates_[i].square[k] /
                                             (fine.rounds[i] * (norm * norm + dark)));
        }
      }
    for (const Grid& grid : coarse) {
      const std::vector<double> here = grid.missed(weights, dark);
      for (size_t i = 0; i < n; ++i) missed[i] = std::max(missed[i], here[i]);
    }
    for (size_t i = 0; i < n; ++i)
      error[i] = out[i] ? kInfinite : calm_mean(scatter[i]) + missed[i];
    weights = pilot_weights(error, out);
  }
  return error;
}

std::vector<double> pilot_weights(const std::vector<double>& relmse, const std::vector<bool>& out) {
  std::vector<double> weights(relmse.size());
  double largest = 0, total = 0;
  for (size_t i = 0; i < relmse.size(); ++i)
    if (!out[i] && std::isfinite(relmse[i])) largest = std::max(largest, relmse[i]);
  if (!(largest > 0)) {
    for (size_t i = 0; i < relmse.size(); ++i)
      if (!out[i]) {
        weights[i] = 1;
        break;
      }
    return weights;
  }
  for (size_t i = 0; i < relmse.size(); ++i)
    if (!out[i]) total += weights[i] = 1 / std::max(relmse[i], 1e-12 * largest);
  for (double& w : weights) w /= total;
  return weights;
}

size_t best_of(const std::vector<PilotRecord>& pilot) {
  size_t best = 0;
  for (size_t i = 1; i < pilot.size(); ++i)
    if (pilot[i].relmse * pilot[i].work < pilot[best].relmse * pilot[best].work) best = i;
  return best;
}

std::vector<bool> hopeless(const std::vector<PilotRecord>& pilot, std::vector<bool> out) {
  const PilotRecord& best = pilot[best_of(pilot)];
  for (size_t i = 0; i < pilot.size(); ++i)
    if (pilot[i].relmse * pilot[i].work > kHopeless * best.relmse * best.work) out[i] = true;
  return out;
}

}  // namespace tdpt
