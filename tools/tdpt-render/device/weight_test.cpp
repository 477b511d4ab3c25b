// The MIS weights of all strategies that could have made a path sum to 1, whatever its densities.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/scaled.h"
#include "shaders/shared/tables.h"
#include "tools/tdpt-render/path/sample/mixture.h"

namespace tdpt::shader::weight_test {

struct Weights {
  using Real = float;
  RenderParameters render{};
  const PathDensity* path_densities = nullptr;
  bool scene_has_portals = true, power_heuristic = false;
  uint mixture_techniques = 0;
  LOADS(PathDensity, path_density, path_densities)
#include "shaders/shared/path/weight.h"
};

constexpr uint kLongest = 9;

// A path of k edges as densities, and as the walk records of any strategy.
struct Path {
  uint k;
  float light_A[kLongest], camera_A[kLongest];  // of x_i, i < k
  float pair_A[kLongest];                       // of x_i -> x_{i+1}, i < k - 1
  float nee_A;
  bool dirac[kLongest + 1]{};
  // Survival probabilities of walks at x_i, a factor of the densities of the next vertex.
  float light_survival[kLongest + 1], camera_survival[kLongest + 1];

  bool connections(uint s) const { return s == 0 || !(dirac[s - 1] || dirac[s]); }

  // Records of x_{s-1} .. x_0 in slots 0 ..
  std::vector<PathDensity> light_records(uint s) const {
    std::vector<PathDensity> records;
    for (uint i = 0; i < s; ++i) {
      PathDensity d{};
      d.own_A = light_A[i];
      d.other_survival = camera_survival[i];
      const bool sure = k - (i + 1) <= 1;
      d.other_A = camera_A[i] / (sure ? 1 : camera_survival[i + 1]);
      d.pair_A = i > 0 ? pair_A[i - 1] : 0;
      d.nee_A = i == 1 ? nee_A : 0;
      d.prev = i > 0 ? i - 1 : kNoVertex;
      d.flags = i | VERTEX_THERE | (dirac[i] ? VERTEX_DIRAC : 0u);
      records.push_back(d);
    }
    return records;
  }
  // Adds those of x_{k-1} .. x_s; x_s is the last.
  void add_camera_records(uint s, std::vector<PathDensity>& records) const {
    for (uint i = k; i-- > s;) {
      PathDensity d{};
      d.own_A = camera_A[i];
      d.other_survival = light_survival[i];
      d.other_A = light_A[i] / (i <= 2 ? 1 : light_survival[i - 1]);
      d.pair_A = i + 1 < k ? pair_A[i] : 0;
      d.nee_A = i == 0 ? nee_A : 0;
      d.prev = i + 1 < k ? static_cast<uint>(records.size() - 1) : kNoVertex;
      d.flags = (k - i) | VERTEX_THERE | (dirac[i] ? VERTEX_DIRAC : 0u);
      records.push_back(d);
    }
  }
  Half<float> light_half(uint s) const {
    if (s == 0) return {kNoVertex, 0, 0};
    return {s - 1, camera_A[s - 1], s > 1 ? camera_A[s - 2] : 0};
  }
  Half<float> camera_half(uint s, const std::vector<PathDensity>& records) const {
    if (s == k) return {kNoVertex, 0, 0};
    return {static_cast<uint>(records.size() - 1), light_A[s], s + 1 < k ? light_A[s + 1] : 0};
  }
};

Path random_path(tdpt::Rng& rng, uint k, bool portals, double decades) {
  Path p{};
  p.k = k;
  const auto density = [&] {
    return static_cast<float>(std::pow(10.0, decades * (rng.uniform() - 0.5)));
  };
  for (uint i = 0; i < k; ++i) {
    p.light_A[i] = density();
    p.camera_A[i] = rng.uniform() < 0.05 ? 0 : density();
    p.light_survival[i] = static_cast<float>(0.1 + 0.9 * rng.uniform());
    p.camera_survival[i] = static_cast<float>(0.1 + 0.9 * rng.uniform());
    if (portals && i + 1 < k && rng.uniform() < 0.5) p.pair_A[i] = density();
    if (i > 0) p.dirac[i] = rng.uniform() < 0.2;
  }
  p.nee_A = density();
  return p;
}

// Sum of the weights of all strategies that can make it.
double sum_of_weights(const RenderParameters& render, const Path& p) {
  Weights weights;
  weights.render = render;
  weights.mixture_techniques = render.techniques;
  weights.power_heuristic = render.beta == 2;
  double sum = 0;
  bool any_zero = false;
  for (uint i = 0; i < p.k; ++i) any_zero |= p.camera_A[i] == 0;
  const auto possible = [&](uint s, uint rest) {
    for (uint i = rest; i < p.k; ++i)
      if (p.camera_A[i] == 0) return false;
    (void)s;
    return true;
  };
  for (uint s = 0; s <= p.k; ++s) {
    std::vector<PathDensity> records = p.light_records(s);
    p.add_camera_records(s, records);
    weights.path_densities = records.data();
    if (!p.connections(s) || !possible(s, s) || weights.weight_of_split(s, p.k) == 0) continue;
    sum += weights.share_of(
        weights.weight_of_split(s, p.k),
        weights.strategies_of_connected(p.light_half(s), p.camera_half(s, records), s, p.k,
                                        s > 0 && s < p.k ? p.pair_A[s - 1] : 0));
  }
  if (weights.has_technique(TECHNIQUE_DIRECT) && p.connections(1) && possible(0, 1)) {
    std::vector<PathDensity> records;
    p.add_camera_records(1, records);
    weights.path_densities = records.data();
    sum += weights.share_of(
        weights.weight_of_direct(p.k),
        weights.strategies_of_next_event(p.camera_half(1, records), p.k, p.nee_A, p.light_A[0],
                                         p.camera_A[0], p.pair_A[0]));
  }
  for (uint a = 0; a + 2 <= p.k && weights.has_technique(TECHNIQUE_PORTAL); ++a) {
    if (!(p.pair_A[a] > 0) || !p.connections(a) || p.dirac[a] || p.dirac[a + 1] ||
        (a + 2 < p.k && p.dirac[a + 2]) || !possible(a, a + 2))
      continue;
    std::vector<PathDensity> records = p.light_records(a);
    p.add_camera_records(a + 2, records);
    weights.path_densities = records.data();
    SegmentDensities<float> x{};
    x.pair_A = p.pair_A[a];
    x.light_A0 = p.light_A[a];
    x.light_A1 = p.light_A[a + 1];
    x.camera_A0 = p.camera_A[a];
    x.camera_A1 = p.camera_A[a + 1];
    x.pair_before = a > 0 ? p.pair_A[a - 1] : 0;
    x.pair_after = a + 2 < p.k ? p.pair_A[a + 1] : 0;
    x.nee_A = p.nee_A;
    sum += weights.share_of(
        weights.weight_of_portal(a, p.k),
        weights.strategies_of_segment(p.light_half(a), p.camera_half(a + 2, records), a, p.k, x));
  }
  return sum;
}

RenderParameters mixture_of(TechniqueSet techniques) {
  RenderParameters render{};
  render.techniques = techniques.bits();
  render.beta = 1;
  render.first_direct = 6;
  render.later_direct = 2;
  render.light_walks = 0.25f;
  render.connected = 1.7f;
  render.connected_to_segments = 1.3f;
  render.segments = 0.5f;
  render.segments_connected = 16;
  return render;
}

// Largest deviation of sum_of_weights() from 1 over random paths that some strategy can make.
double worst(const RenderParameters& render, bool portals, double decades) {
  tdpt::Rng rng(3, 0, 0);
  double most = 0;
  for (int n = 0; n < 20000; ++n) {
    const Path p =
        random_path(rng, 2 + static_cast<uint>(rng.uniform() * (kLongest - 2)), portals, decades);
    const double sum = sum_of_weights(render, p);
    if (sum > 0) most = std::max(most, std::abs(sum - 1));
  }
  return most;
}

constexpr TechniqueSet kAll(Technique::camera, Technique::direct, Technique::light, Technique::bi,
                            Technique::portal);

TEST(weights_of_kernels, add_up_to_1) {
  for (const TechniqueSet techniques :
       {kAll, TechniqueSet(Technique::camera), TechniqueSet(Technique::camera, Technique::direct),
        TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::bi),
        TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::portal)})
    for (RenderParameters render = mixture_of(techniques); render.beta <= 2; render.beta += 1)
      EXPECT_LT(worst(render, techniques.has(Technique::portal), 4), 2e-5)
          << int{techniques.bits()} << " " << render.beta;
}

// Products of densities exceed the range of floats by far.
TEST(weights_of_kernels, add_up_to_1_at_the_extremes) {
  for (RenderParameters render = mixture_of(kAll); render.beta <= 2; render.beta += 1)
    EXPECT_LT(worst(render, true, 40), 2e-5);
}

TEST(weights_of_kernels, twin_a_strategy_that_counts_otherwise_is_seen) {
  tdpt::Rng rng(4, 0, 0);
  RenderParameters render = mixture_of(kAll);
  double most = 0;
  for (int n = 0; n < 1000; ++n) {
    Path p = random_path(rng, 5, true, 2);
    for (bool& dirac : p.dirac) dirac = false;
    Weights weights;
    weights.render = render;
    weights.mixture_techniques = render.techniques;
    weights.power_heuristic = render.beta == 2;
    std::vector<PathDensity> records = p.light_records(3);
    p.add_camera_records(3, records);
    weights.path_densities = records.data();
    const auto weight = [&] {
      return weights.share_of(weights.weight_of_split(3, 5),
                              weights.strategies_of_connected(
                                  p.light_half(3), p.camera_half(3, records), 3, 5, p.pair_A[2]));
    };
    const float right = weight();
    records[1].pair_A *= 1.5f;
    const float wrong = weight();
    most = std::max<double>(most, std::abs(wrong - right));
  }
  EXPECT_GT(most, 0.01);
}

}  // namespace tdpt::shader::weight_test
