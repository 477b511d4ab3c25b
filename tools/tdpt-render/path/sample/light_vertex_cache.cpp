#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

#include <algorithm>
#include <cmath>

#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

// Share of the probability spread equally over all terms: an estimate knows neither shadows nor
// weights.
constexpr double kEqualShare = 0.5;

}  // namespace

// k for which the sum of min(1, k e_i) is `count`, if more terms than that are not 0 and their e_i
// sum to 1.
double Resampling::factor(uint32_t count) const {
  double k = count;
  for (;;) {
    double rest = 0;
    uint32_t sure = 0;
    for (const auto& [number, e] : terms())
      if (k * e < 1)
        rest += e;
      else
        ++sure;
    if (sure >= count) return k;
    const double next = (count - sure) / rest;
    if (!(next > k)) return k;
    k = next;
  }
}

// Branch-free: which terms are chosen cannot be predicted.
std::span<const Resampling::Taken> Resampling::choose(uint32_t count, double u) {
  if (taken_.size() < not_zero_ + 1) taken_.resize(not_zero_ + 1);
  double total = 0;
  for (const auto& [number, e] : terms()) total += e;
  // NaN must not be importance-sampled away: keep it, so that it is counted and reported.
  if (not_zero_ <= count || !std::isfinite(total)) {
    for (size_t i = 0; i < not_zero_; ++i) taken_[i] = {terms_[i].number, 1};
    return {taken_.data(), not_zero_};
  }
  const double by_estimate = (1 - kEqualShare) / total;
  const double equal_share = kEqualShare / static_cast<double>(not_zero_);
  double largest = 0;
  for (size_t i = 0; i < not_zero_; ++i) {
    double& e = terms_[i].estimate;
    e = e * by_estimate + equal_share;
    largest = std::max(largest, e);
  }
  const double k = count * largest < 1 ? count : factor(count);
  double before = u;
  size_t n = 0;
  for (const auto& [number, e] : terms()) {
    const double chance = std::min(1.0, k * e), after = before + chance;
    taken_[n] = {number, chance};
    n += static_cast<int>(after) > static_cast<int>(before);
    before = after;
  }
  return {taken_.data(), n};
}

uint64_t samples_of_cache(const Mixture& mixture) {
  return static_cast<uint64_t>(std::lround(LightVertexCache::kWalks / mixture.light_walks));
}

uint64_t light_walks_of(const Mixture& mixture, uint64_t samples) {
  if (!mixture.techniques.walks_from_light() || samples == 0) return 0;
  const double walks = mixture.light_walks * static_cast<double>(samples);
  return std::clamp<uint64_t>(static_cast<uint64_t>(std::lround(walks)), 1, samples);
}

uint64_t pixel_of_cache(uint64_t cache, uint64_t i, uint64_t caches, uint64_t pixels) {
  const uint64_t stretch = i * caches;
  if (stretch + caches > pixels) return stretch + cache;
  constexpr double kGolden = 0.6180339887498949;
  const auto along = static_cast<uint64_t>(kGolden * static_cast<double>(stretch));
  return stretch + (cache + along) % caches;
}

void LightVertexCache::clear(uint64_t samples) {
  starts_.clear();
  scattered_.clear();
  walks_ = 0;
  samples_ = static_cast<double>(samples);
  kept_ = 0;
  columns_.clear();
  segment_ends_.clear();
  segment_columns_.clear();
}

PortalSegment& LightVertexCache::place_for_segment() {
  if (kept_ == segments_.size()) segments_.emplace_back();
  return segments_[kept_];
}

void LightVertexCache::prepare_segments() {
  for (size_t i = segment_ends_.size(); i < kept_; ++i) {
    const PortalSegment& segment = segments_[i];
    segment_columns_.add(segment_ends_.emplace_back(segment.x_c, -segment.w, segment.through));
    Rgb light;
    for (const Side& side : segment.light) light += side.value;
    segment_columns_.set_light(i, light);
  }
}

void LightVertexCache::add(const Walk& y) {
  ++walks_;
  if (y.size > 0 && y[0].connectible) starts_.emplace_back(y, 0);
  for (int i = 1; i < y.size; ++i) {
    if (!y[i].connectible) continue;
    columns_.add(scattered_.emplace_back(y, i));
    columns_.set_light(columns_.size() - 1, Rgb(1.0f));
  }
}

void LightVertexCache::estimate(const std::vector<const LightVertex*>& drawn, const End& end,
                                std::vector<double>& estimates) const {
  static_assert(kCandidates == Ends::kLanes);
  std::array<int, kCandidates> places{};
  size_t n = 0;
  for (const LightVertex* y : drawn)
    places[n++] = y->index > 0 ? static_cast<int>(y - scattered_.data()) : 0;
  if (estimates.size() < kCandidates) estimates.resize(kCandidates);
  if (columns_.size() > 0) columns_.estimate(end, places, estimates.data());
}

double LightVertexCache::draw(bool starts, double u, std::vector<const LightVertex*>& drawn) const {
  drawn.clear();
  const size_t n = scattered_.size() + (starts ? starts_.size() : 0);
  const auto at = [&](size_t i) {
    return i < scattered_.size() ? &scattered_[i] : &starts_[i - scattered_.size()];
  };
  if (n == 0) return 0;
  drawn.resize(std::min<size_t>(n, kCandidates));
  if (n <= kCandidates) {
    for (size_t i = 0; i < n; ++i) drawn[i] = at(i);
    return walks_;
  }
  const double step = static_cast<double>(n) / kCandidates;
  for (size_t i = 0; i < kCandidates; ++i)
    drawn[i] = at(std::min(n - 1, static_cast<size_t>((static_cast<double>(i) + u) * step)));
  return walks_ / step;
}

LightVertices expected_light_vertices(const Vista& vista, const Guiding& guiding, int max_depth) {
  constexpr int kWalks = 512;
  Mixture mixture;
  mixture.guiding = guiding;
  const Guide guide(vista, mixture);
  RayCounts rays;
  Walk y;
  LightVertices sum;
  for (int i = 0; i < kWalks; ++i) {
    walk_from_light(
        vista, guide, max_depth - 1,
        Sequence(*kExpectedWalks.seed, kExpectedWalks.first, 0, static_cast<uint64_t>(i)), y, rays);
    for (int j = 0; j < y.size; ++j)
      if (y[j].connectible) ++(j == 0 ? sum.first : sum.later);
  }
  return {sum.first / kWalks, sum.later / kWalks};
}

Mixture expecting_connections(const LightVertices& vertices, const Mixture& mixture) {
  Mixture expecting = mixture;
  if (!mixture.techniques.walks_from_light()) return expecting;
  // A vertex connects with at most all kWalks walks of a cache.
  const auto connections = [](double of_walk) {
    return LightVertexCache::kCandidates /
           std::max(of_walk, double{LightVertexCache::kCandidates} / LightVertexCache::kWalks);
  };
  expecting.connected = connections(vertices.later);
  expecting.connected_to_segments = connections(vertices.first + vertices.later);
  if (mixture.has(Technique::portal))
    expecting.segments_connected = static_cast<double>(samples_of_cache(mixture));
  return expecting;
}

Mixture expecting_connections(const Vista& vista, const Mixture& mixture, int max_depth) {
  if (!mixture.techniques.walks_from_light()) return mixture;
  return expecting_connections(expected_light_vertices(vista, mixture.guiding, max_depth), mixture);
}

}  // namespace tdpt
