// Samples from a list of entries with given weights by inverting the cumulative distribution.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tdpt {

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
