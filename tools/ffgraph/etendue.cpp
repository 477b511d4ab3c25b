#include "tools/ffgraph/etendue.h"

#include <algorithm>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

constexpr uint64_t kStream = 103;
constexpr int kDensestLevel = 2;

double density(int level) {
  return std::ldexp(1.0, 2 * std::min(level, kDensestLevel));
}

// Sums the weights of equal pairs. Weights are powers of two, so sums do not depend on order.
void merge(std::vector<Etendue::Pair>& pairs) {
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
  size_t kept = 0;
  for (const Etendue::Pair& p : pairs) {
    if (kept > 0 && pairs[kept - 1].i == p.i && pairs[kept - 1].j == p.j)
      pairs[kept - 1].count += p.count;
    else
      pairs[kept++] = p;
  }
  pairs.resize(kept);
}

}  // namespace

Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays) {
  Etendue e;
  e.samples.assign(patches.size(), 0);
  if (fragments.all().empty()) return e;
  std::vector<double> weights;
  double total = 0;
  for (const Fragments::Fragment& f : fragments.all()) {
    weights.push_back(f.area * density(patches.keys()[f.patch].level));
    total += weights.back();
  }
  for (const Fragments::Fragment& f : fragments.all()) e.samples[f.patch] += rays * f.area / total;
  const AliasTable table(weights);

  std::vector<Etendue::Pair> ray(rays, {kNoPatch, kNoPatch, 0});
  tbb::parallel_for(uint32_t{0}, rays, [&](uint32_t k) {
    Rng rng(seed, kStream, k);
    const uint32_t fragment = table.sample(rng.uniform());
    const Fragments::Point from = fragments.sample(fragment, rng);
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = Onb<double>(from.normal).to_world(cosine_hemisphere(u, v));
    Hit hit;
    if (!tracer.closest({from.position, from.normal}, w, hit)) return;
    const uint32_t to =
        patches.find(2 * hit.triangle + (dot(hit.normal, w) > 0 ? 1 : 0), hit.position);
    if (to == kNoPatch || to == from.patch) return;
    ray[k] = {std::min(from.patch, to), std::max(from.patch, to),
              1 / density(patches.keys()[from.patch].level)};
  });
  std::erase_if(ray, [](const Etendue::Pair& p) { return p.i == kNoPatch; });
  merge(ray);
  e.pairs = std::move(ray);
  return e;
}

}  // namespace tdpt
