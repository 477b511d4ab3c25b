#include "tools/tdpt-render/pilot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcommon/formats/portal_worth.h"

namespace tdpt {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// exrdiff's: errors of pixels darker than a tenth of the picture's mean count less.
constexpr double kDark = 0.01;
// About so many blocks a picture: each has pixels enough to know its mean.
constexpr double kBlocks = 300;
constexpr double kSurely = 2;  // standard errors

Vec3d times(const Vec3d& a, const Vec3d& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

}  // namespace

bool all_useless(const std::vector<Portal>& portals) {
  return std::all_of(portals.begin(), portals.end(), [](const Portal& p) {
    return verdict_of(p.figures).worth == Worth::useless;
  });
}

std::vector<Candidate> auto_candidates(const World& world, const std::vector<Portal>& portals) {
  std::vector<const Integrator*> order;
  if (world.portals.empty())
    order = {&bdpt, &nee, &pt};
  else if (all_useless(portals))
    order = {&bdpt, &tdpt_org, &nee, &tdpt_ref};
  else
    order = {&tdpt_org, &bdpt, &tdpt_ref, &nee};
  std::vector<Candidate> candidates;
  for (const Integrator* integrator : order)
    if (light_missed(*integrator, world.scene).empty())
      candidates.push_back({integrator, integrator->name});
  return candidates;
}

Integrator either_of(const std::vector<Candidate>& candidates) {
  Integrator any = *candidates.front().integrator;
  any.name = "auto";
  any.sample = nullptr;
  for (const Candidate& c : candidates) any.techniques = any.techniques | c.integrator->techniques;
  return any;
}

WorkModel::WorkModel(const World& world) : portals_(!world.portals.empty()) {
  const double depth =
      std::max(0.0, std::log2(static_cast<double>(world.scene.triangles.size() + 1) / 64));
  closest_ = portals_ ? 39 + 12 * depth : 193 + 11 * depth;
  portal_ = 161 + 2 * static_cast<double>(world.portals.size());
}

double WorkModel::per_sample(const RayCounts& rays, uint64_t samples) const {
  const double n = static_cast<double>(std::max<uint64_t>(samples, 1));
  return (portals_ ? 140 : 5) + closest_ * static_cast<double>(rays.closest) / n +
         (portals_ ? 174 : 215) * static_cast<double>(rays.shadow) / n +
         portal_ * static_cast<double>(rays.portal) / n;
}

PilotPlan plan_pilot(double spp, size_t candidates, bool exact) {
  if (spp < kLeastSpp || candidates < 2) return {};
  PilotPlan plan;
  plan.candidates = static_cast<size_t>(std::min(static_cast<double>(candidates), spp / 16));
  const double passes = 2 * static_cast<double>(plan.candidates);
  plan.rounds = static_cast<uint64_t>(std::clamp(spp / 16 / passes, 2.0, 8.0));
  // Each round counts as the two samples that the chosen one would have taken instead. Where the
  // time is what ends the rendering, another than the first candidate may get further in it.
  plan.kept = 2 * static_cast<double>(plan.rounds) / (exact ? spp : 2 * spp);
  return plan;
}

PilotErrors::PilotErrors(int width, int height, size_t candidates)
    : width_(width), height_(height), candidates_(candidates) {
  side_ = std::max(1, static_cast<int>(std::sqrt(width * static_cast<double>(height) / kBlocks)));
  across_ = (width + side_ - 1) / side_;
  const size_t down = static_cast<size_t>((height + side_ - 1) / side_);
  pixels_.resize(static_cast<size_t>(across_) * down);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ++pixels_[block_of(x, y)];
  for (OfCandidate& c : candidates_) c.blocks.resize(pixels_.size());
}

void PilotErrors::add_round(size_t candidate, const std::vector<Vec3d>& first,
                            const std::vector<Vec3d>& second) {
  OfCandidate& c = candidates_[candidate];
  ++c.rounds;
  size_t i = 0;
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x, ++i) {
      Block& block = c.blocks[block_of(x, y)];
      const Vec3d d = first[i] - second[i];
      block.sum += first[i] + second[i];
      block.square += times(d, d) * 0.5;
    }
}

std::vector<double> PilotErrors::relmse() const {
  const size_t n = candidates_.size(), blocks = pixels_.size();
  std::vector<double> error(n, kInfinite);
  // Variance of a sample and mean of candidate i, colour c, block b.
  const auto variance = [&](size_t i, size_t b, int c) {
    return candidates_[i].blocks[b].square[c] /
           (pixels_[b] * static_cast<double>(candidates_[i].rounds));
  };
  const auto samples = [&](size_t i, size_t b) {
    return 2 * pixels_[b] * static_cast<double>(candidates_[i].rounds);
  };
  const auto mean = [&](size_t i, size_t b, int c) {
    return candidates_[i].blocks[b].sum[c] / samples(i, b);
  };
  std::vector<bool> out(n);
  for (size_t i = 0; i < n; ++i) out[i] = candidates_[i].rounds == 0;
  if (std::all_of(out.begin(), out.end(), [](bool o) { return o; })) return error;

  // The normaliser needs weights and the weights a normaliser.
  std::vector<double> weights = pilot_weights(std::vector<double>(n, 1), out);
  for (int turn = 0; turn < 3; ++turn) {
    std::vector<Vec3d> picture(blocks);
    double total = 0, pixels = 0;
    for (size_t b = 0; b < blocks; ++b) {
      for (int c = 0; c < 3; ++c)
        for (size_t i = 0; i < n; ++i)
          if (weights[i] > 0) picture[b][c] += weights[i] * mean(i, b, c);
      total += pixels_[b] * (picture[b].x + picture[b].y + picture[b].z) / 3;
      pixels += pixels_[b];
    }
    const double dark = kDark * (total / pixels) * (total / pixels);
    if (!(dark > 0)) return std::vector<double>(n, 0);
    for (size_t i = 0; i < n; ++i) error[i] = out[i] ? kInfinite : 0;
    for (size_t b = 0; b < blocks; ++b)
      for (int c = 0; c < 3; ++c) {
        double surely = 0;
        for (size_t i = 0; i < n; ++i)
          if (!out[i])
            surely = std::max(
                surely, mean(i, b, c) - kSurely * std::sqrt(variance(i, b, c) / samples(i, b)));
        const double scale = pixels_[b] / (3 * pixels * (picture[b][c] * picture[b][c] + dark));
        for (size_t i = 0; i < n; ++i) {
          if (out[i]) continue;
          const double missing = std::max(0.0, surely - mean(i, b, c));
          error[i] += scale * (variance(i, b, c) + samples(i, b) * missing * missing);
        }
      }
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
