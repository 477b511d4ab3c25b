#include "tools/ffgraph/etendue.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "libcommon/math/alias_table.h"
#include "libcommon/math/streams.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {
namespace {

constexpr int kDensestLevel = 2;

// `level`: relative to that of the fine region.
double density(int level) {
  return std::ldexp(1.0, 2 * std::min(level, kDensestLevel));
}

using Ends = std::pair<uint32_t, uint32_t>;  // smaller index first

// For walks that left to the sky, the sky's patch replaces the end mark.
void add_steps(const PatchMap& patches, const PatchTrace& walks, std::vector<double>& starts,
               std::vector<Ends>& rays) {
  const auto on_patch = [](uint32_t entry) { return entry < kTraceStopped; };
  for (size_t k = 0; k + 1 < walks.size(); ++k) {
    const uint32_t from = walks[k], to = walks[k + 1];
    if (!on_patch(from) || patches.is_sky(from) || to == kTraceStopped) continue;
    starts[from] += 1;
    if (on_patch(to) && to != from) rays.push_back(std::minmax(from, to));
  }
}

// Counts rays with equal ends. q: rays that start on a patch per sample.
std::vector<Etendue::Pair> pairs_of(std::vector<Ends>& rays, const std::vector<double>& q) {
  const auto key = [](const Ends& e) { return uint64_t{e.first} << 32 | e.second; };
  tbb::parallel_sort(rays.begin(), rays.end(),
                     [key](const Ends& a, const Ends& b) { return key(a) < key(b); });
  std::vector<Etendue::Pair> pairs;
  for (size_t k = 0; k < rays.size();) {
    size_t end = k;
    while (end < rays.size() && rays[end] == rays[k]) ++end;
    const auto [i, j] = rays[k];
    pairs.push_back({i, j, 2 * static_cast<double>(end - k) / (q[i] + q[j])});
    k = end;
  }
  return pairs;
}

}  // namespace

Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays, const std::vector<PatchTrace>& walks) {
  Etendue e;
  e.samples.assign(patches.size(), 0);
  if (fragments.all().empty()) return e;
  std::vector<double> weights, starts(patches.size(), 0);
  double total = 0;
  for (const Fragments::Fragment& f : fragments.all()) {
    weights.push_back(f.area * density(patches.keys()[f.patch].level - patches.fine_level()));
    total += weights.back();
  }
  size_t k = 0;
  for (const Fragments::Fragment& f : fragments.all()) {
    e.samples[f.patch] += rays * f.area / total;
    starts[f.patch] += rays * weights[k++] / total;
  }
  const AliasTable table(weights);

  std::vector<Ends> ray(rays, {kNoPatch, kNoPatch});
  tbb::parallel_for(uint32_t{0}, rays, [&](uint32_t n) {
    Rng rng(seed, kEtendue.first, n);
    const uint32_t fragment = table.sample(rng.uniform());
    const Fragments::Point from = fragments.sample(fragment, rng);
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = Onb<double>(from.normal).to_world(cosine_hemisphere(u, v));
    Hit hit;
    const uint32_t to =
        tracer.closest({from.position, from.normal}, w, hit)
            ? patches.find(2 * hit.triangle + (dot(hit.normal, w) > 0 ? 1 : 0), hit.position)
        : patches.has_sky() && hit.triangle == ~0u ? patches.find_sky(sky_bin(w))
                                                   : kNoPatch;
    if (to != kNoPatch && to != from.patch) ray[n] = std::minmax(from.patch, to);
  });
  std::erase_if(ray, [](const Ends& r) { return r.first == kNoPatch; });
  for (const PatchTrace& trace : walks) add_steps(patches, trace, starts, ray);
  for (size_t i = 0; i < starts.size(); ++i)
    if (e.samples[i] > 0) starts[i] /= e.samples[i];
  e.pairs = pairs_of(ray, starts);
  // No ray starts in the sky; a bin's samples are half the sum of what it exchanges.
  for (const Etendue::Pair& p : e.pairs)
    for (const uint32_t end : {p.i, p.j})
      if (patches.is_sky(end)) e.samples[end] += 0.5 * p.count;
  return e;
}

}  // namespace tdpt
