// For tests: renders a scene with several integrators and compares them for each path length.
// Sections 3.1 and 3.3: all of them estimate the same integral.
//
// The observer of PathSampler sees every contribution with its path, so one run of depth 8 gives
// the light of exactly k edges for every k. agreement_test.cpp tests that a run of a smaller depth
// has the same light of each length.
#pragma once
#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/testing/statistics/power.h"
#include "libcommon/testing/statistics/z_failure.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt {

struct AgreementSettings {
  int max_depth = 8;
  size_t runs = 16;
  uint64_t spp = 16;  ///< of each run
  int block = 4;      ///< side of the blocks [pixels]; width and height are multiples of it
  int apart = 8;      ///< number of lengths kept apart; longer paths are taken together
  uint64_t first_seed = 1;

  /// For the reference: more samples, the factor being cheapest for four or five comparisons.
  AgreementSettings of_reference() const {
    AgreementSettings calm = *this;
    calm.spp *= 2;
    calm.first_seed += 1000;
    return calm;
  }
  /// Number of path lengths, [0] for all together.
  size_t lengths() const { return static_cast<size_t>(std::min(max_depth, apart + 1)) + 1; }
};

/// Luminance of blocks: [k] for paths of exactly k edges, the last also for longer ones, [0] for
/// all.
struct DepthRuns {
  std::vector<testing::BlockRuns> of_depth;
  size_t across = 0;  ///< blocks in a row
  uint64_t not_finite = 0;
  uint64_t spp = 0;  ///< of all runs
};

/// One picture per path length as in DepthRuns, [0] unused, luminance per pixel and sample.
inline std::vector<std::vector<double>> render_by_depth(const Vista& vista, const Variant& variant,
                                                        const AgreementSettings& settings,
                                                        uint64_t seed, Tally& tally) {
  const int width = vista.view.film.width(), height = vista.view.film.height();
  std::vector<std::vector<double>> pictures(
      settings.lengths(),
      std::vector<double>(static_cast<size_t>(width) * static_cast<size_t>(height)));
  Film film(width, height, 1);
  int px = 0, py = 0;
  const PathObserver observer = [&](const Contribution& found) {
    const auto& [path, strategy, value, times] = found;
    const int k = path.k();
    int x = px, y = py;
    if (strategy.technique == Technique::light ||
        (strategy.technique == Technique::portal && strategy.split == k - 2)) {  // a splat
      double raster_x, raster_y;
      const Vec3d w = normalize(path.vertex(k - 1).position - path.film().position());
      if (!path.film().raster(w, raster_x, raster_y)) return;
      x = static_cast<int>(raster_x);
      y = static_cast<int>(raster_y);
    }
    const double weighted =
        luminance(value) * path.weight(variant.integrator.mixture, strategy,
                                       variant.beta[static_cast<size_t>(strategy.technique)]);
    if (std::isfinite(weighted))
      pictures[std::min(static_cast<size_t>(k), pictures.size() - 1)]
              [static_cast<size_t>(y * width + x)] += weighted / static_cast<double>(settings.spp);
  };
  PathSampler sampler(vista, variant.settings(settings.max_depth, seed), film, tally, &observer);
  variant.picture(sampler, width, height, settings.spp, [&](int x, int y) { px = x, py = y; });
  return pictures;
}

inline DepthRuns render_runs(const Vista& vista, const Variant& variant,
                             const AgreementSettings& settings) {
  const int width = vista.view.film.width(), height = vista.view.film.height(),
            side = settings.block;
  const size_t depths = settings.lengths();
  const auto across = static_cast<size_t>(width / side), down = static_cast<size_t>(height / side);
  using Blocks = std::vector<std::vector<double>>;  // [k][block]
  std::vector<Blocks> runs(settings.runs, Blocks(depths, std::vector<double>(across * down)));
  std::vector<Tally> tallies(settings.runs);
  tbb::parallel_for(size_t{0}, settings.runs, [&](size_t r) {
    const auto pictures = render_by_depth(vista, variant, settings,
                                          testing::fresh(settings.first_seed + r), tallies[r]);
    for (size_t k = 1; k < depths; ++k)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const double v =
              pictures[k][static_cast<size_t>(y * width + x)] / static_cast<double>(side * side);
          const size_t b = static_cast<size_t>(y / side) * across + static_cast<size_t>(x / side);
          runs[r][k][b] += v;
          runs[r][0][b] += v;
        }
  });
  DepthRuns out;
  out.of_depth.resize(depths);
  out.across = across;
  out.spp = settings.runs * settings.spp;
  for (size_t r = 0; r < settings.runs; ++r) {
    for (size_t k = 0; k < depths; ++k) out.of_depth[k].add(runs[r][k]);
    out.not_finite += tallies[r].not_finite;
  }
  return out;
}

struct Verdict {
  int disagreements = 0;  ///< number of lengths that disagree, counting all together as one
  std::vector<testing::Agreement> of_depth;  ///< as in DepthRuns

  bool holds() const { return disagreements == 0; }
};

/// Significance level of one comparison: a whole test, three comparisons for each length of nine
/// renderers, then fails by chance no more often than a test may.
inline constexpr double kLeast = testing::kFalseAlarm / 256;

/// `how`: testing::compare, or testing::compare_paired for runs that share their random numbers.
inline Verdict judge(const DepthRuns& runs, const DepthRuns& reference,
                     testing::Agreement (*how)(const testing::BlockRuns&,
                                               const testing::BlockRuns&) = testing::compare) {
  Verdict out;
  for (size_t k = 0; k < runs.of_depth.size(); ++k) {
    testing::Agreement a = how(runs.of_depth[k], reference.of_depth[k]);
    a.least = kLeast;
    testing::tell_answer(a, runs.spp, k);
    out.disagreements += !a.holds();
    out.of_depth.push_back(a);
  }
  return out;
}

/// Whether the verdict on these runs holds; if not, reports every depth that disagrees and keeps
/// its pictures [z_failure.h]. A twin uses verdict.holds().
inline ::testing::AssertionResult holds(const Verdict& verdict, const std::string& what,
                                        const DepthRuns& runs, const DepthRuns& reference) {
  if (verdict.holds()) return ::testing::AssertionSuccess();
  ::testing::AssertionResult all = ::testing::AssertionFailure();
  for (size_t k = 0; k < runs.of_depth.size(); ++k) {
    const std::string depth = k == 0 ? ", all depths" : ", depth " + std::to_string(k);
    all << testing::holds(verdict.of_depth[k], what + depth, runs.of_depth[k],
                          reference.of_depth[k], runs.across)
               .message();
  }
  return all;
}

/// Compares each of `others` with the reference.
inline void expect_agreement(const Vista& vista, const std::vector<Variant>& others,
                             const DepthRuns& reference, const AgreementSettings& settings) {
  EXPECT_EQ(reference.not_finite, 0u);
  EXPECT_GT(reference.of_depth[0].mean(), 0);
  for (const Variant& variant : others) {
    const DepthRuns runs = render_runs(vista, variant, settings);
    EXPECT_EQ(runs.not_finite, 0u);
    EXPECT_TRUE(holds(judge(runs, reference), std::string(variant.integrator.name) + " and bdpt",
                      runs, reference));
  }
}

/// Compares each of `others`, with MIS exponent `beta`, with bdpt and the balance heuristic. The
/// twin counts portal segments twice, in the same room with as many samples.
inline void expect_agreement(const Vista& vista, const std::vector<const Integrator*>& others,
                             const AgreementSettings& settings, double beta = 1) {
  std::vector<Variant> variants;
  for (const Integrator* integrator : others) {
    variants.emplace_back(*integrator);
    variants.back().beta.fill(beta);
  }
  const DepthRuns reference = render_runs(vista, bdpt, settings.of_reference());
  expect_agreement(vista, variants, reference, settings);
  const Variant twice(tdpt_org, run_twice<Technique::portal>);
  EXPECT_FALSE(judge(render_runs(vista, twice, settings), reference).holds());
}

}  // namespace tdpt
