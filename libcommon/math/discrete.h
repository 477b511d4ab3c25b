// Samples from a list of entries with given weights.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tdpt {

/// Discrete distribution in proportion to non-negative weights, at least one of them positive.
/// Alias method (Vose): constant time per sample.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights) {
    const size_t n = weights.size();
    double total = 0;
    for (double w : weights) total += w;
    pdf_1_.resize(n);
    threshold_.assign(n, 1.0);
    alias_.resize(n);
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (size_t i = 0; i < n; ++i) {
      pdf_1_[i] = weights[i] / total;
      scaled[i] = pdf_1_[i] * static_cast<double>(n);
      alias_[i] = static_cast<uint32_t>(i);
      (scaled[i] < 1 ? small : large).push_back(static_cast<uint32_t>(i));
    }
    uint32_t heaviest = 0;
    for (size_t i = 1; i < n; ++i)
      if (pdf_1_[i] > pdf_1_[heaviest]) heaviest = static_cast<uint32_t>(i);
    while (!small.empty() && !large.empty()) {
      const uint32_t s = small.back(), l = large.back();
      small.pop_back();
      threshold_[s] = scaled[s];
      alias_[s] = l;
      scaled[l] -= 1 - scaled[s];
      if (scaled[l] < 1) {
        large.pop_back();
        small.push_back(l);
      }
    }
    // Entries left over by rounding must never be drawn if their weight is 0.
    for (uint32_t s : small)
      if (pdf_1_[s] == 0) threshold_[s] = 0, alias_[s] = heaviest;
  }

  bool empty() const { return pdf_1_.empty(); }
  size_t size() const { return pdf_1_.size(); }
  /// Probability of entry i.
  double pdf_1(uint32_t i) const { return pdf_1_[i]; }
  /// Slot i: the probability to keep it, and the entry taken otherwise.
  double threshold(uint32_t i) const { return threshold_[i]; }
  uint32_t alias(uint32_t i) const { return alias_[i]; }
  uint32_t sample(double u) const {
    const double x = u * static_cast<double>(pdf_1_.size());
    const auto i = std::min(static_cast<uint32_t>(x), static_cast<uint32_t>(pdf_1_.size() - 1));
    return x - i < threshold_[i] ? i : alias_[i];
  }

 private:
  std::vector<double> pdf_1_, threshold_;
  std::vector<uint32_t> alias_;
};

/// Discrete distribution in proportion to non-negative weights, at least one of them positive. The
/// inverse is found by a guide table (Chen and Asau 1974): two steps per sample on average, for any
/// number of entries.
///
/// The inversion is monotonic, so stratified numbers stay stratified over the entries. An alias
/// table is not: it also uses the low bits of its number, and with a digitally shifted sequence
/// those are the same for all samples of a pixel, so one sun among many dim texels would get all of
/// them or hardly any.
class CumulativeTable {
 public:
  CumulativeTable() = default;
  explicit CumulativeTable(const std::vector<double>& weights) {
    const size_t n = weights.size();
    double total = 0, sum = 0;
    for (double w : weights) total += w;
    pdf_1_.resize(n);
    end_.resize(n);
    size_t last = 0;
    for (size_t i = 0; i < n; ++i) {
      pdf_1_[i] = weights[i] / total;
      sum += weights[i];
      end_[i] = sum / total;
      if (weights[i] > 0) last = i;
    }
    // Despite rounding, every number in [0,1) finds an entry whose weight is not 0.
    for (size_t i = 0; i < n; ++i) end_[i] = i < last ? std::min(end_[i], 1.0) : 1;
    guide_.resize(n);
    uint32_t entry = 0;
    for (size_t slot = 0; slot < n; ++slot) {
      while (end_[entry] <= static_cast<double>(slot) / static_cast<double>(n)) ++entry;
      guide_[slot] = entry;
    }
  }

  bool empty() const { return pdf_1_.empty(); }
  size_t size() const { return pdf_1_.size(); }
  /// Probability of entry i.
  double pdf_1(uint32_t i) const { return pdf_1_[i]; }
  /// u in [0,1).
  uint32_t sample(double u) const {
    const auto slot = static_cast<size_t>(u * static_cast<double>(guide_.size()));
    uint32_t entry = guide_[std::min(slot, guide_.size() - 1)];
    while (entry > 0 && u < end_[entry - 1]) --entry;  // u * n was rounded up to the next slot
    while (u >= end_[entry]) ++entry;
    return entry;
  }

 private:
  std::vector<double> pdf_1_, end_;  // cumulative: entries 0 .. i
  std::vector<uint32_t> guide_;      // first candidate for u in [slot, slot + 1) / size()
};

}  // namespace tdpt
