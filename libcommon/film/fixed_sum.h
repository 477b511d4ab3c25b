// 128-bit fixed-point sums, which do not depend on the order of additions.
//
// A value v becomes v / unit units, stochastically rounded so that its mean stays v: values far
// below a unit are not lost on average. The random bits are a hash of what is added, so that they
// are the same in every run.
#pragma once
#include <atomic>
#include <cstdint>

namespace tdpt {

using Units = unsigned __int128;

/// At most 2^110 units, so that 2^18 of the largest fit into a sum. False for negative, non-finite
/// and larger values. `coin`: uniform in 0..2^64-1; `per_unit`: 1 / unit, a power of two.
inline bool to_units(double value, double per_unit, uint64_t coin, Units& units) {
  const double scaled = value * per_unit;
  units = 0;
  if (!(scaled >= 0 && scaled < 0x1p110)) return false;
  if (scaled < 0x1p53) {
    const auto whole = static_cast<uint64_t>(scaled);
    units =
        whole + (static_cast<double>(coin >> 11) * 0x1p-53 < scaled - static_cast<double>(whole));
    return true;
  }
  const auto high = static_cast<uint64_t>(scaled * 0x1p-53);  // the rest is exact
  units = (static_cast<Units>(high) << 53) +
          static_cast<uint64_t>(scaled - static_cast<double>(high) * 0x1p53);
  return true;
}
inline double from_units(Units units, double unit) {
  return (static_cast<double>(static_cast<uint64_t>(units >> 64)) * 0x1p64 +
          static_cast<double>(static_cast<uint64_t>(units))) *
         unit;
}

/// Thread-safe. Each wrap of the lower word carries exactly once, whatever the order.
class FixedSum {
 public:
  /// False if the sum wraps round.
  bool add(Units units) {
    const auto low = static_cast<uint64_t>(units);
    const auto high = static_cast<uint64_t>(units >> 64);
    const bool carry = low_.fetch_add(low, std::memory_order_relaxed) > ~low;
    if (high == 0 && !carry) return true;
    const Units before = high_.fetch_add(high + carry, std::memory_order_relaxed);
    return (before + high + carry) >> 64 == 0;
  }
  /// After all additions.
  Units units() const {
    return static_cast<Units>(high_.load(std::memory_order_relaxed)) << 64 |
           low_.load(std::memory_order_relaxed);
  }
  void set(Units units) {
    low_.store(static_cast<uint64_t>(units), std::memory_order_relaxed);
    high_.store(static_cast<uint64_t>(units >> 64), std::memory_order_relaxed);
  }

 private:
  std::atomic<uint64_t> low_{0}, high_{0};
};

/// A sum for one thread, with its unit.
class UnitSum {
 public:
  UnitSum() = default;
  explicit UnitSum(double unit) : unit_(unit), per_unit_(1 / unit) {}
  /// Rounds down: for statistics, not for pictures. Ignores what cannot be represented.
  void add(double value) {
    Units units;
    if (to_units(value, per_unit_, ~uint64_t{0}, units)) units_ += units;
  }
  void merge(const UnitSum& other) { units_ += other.units_; }
  void merge(Units units) { units_ += units; }
  Units units() const { return units_; }
  operator double() const { return from_units(units_, unit_); }

 private:
  Units units_ = 0;
  double unit_ = 1, per_unit_ = 1;
};

}  // namespace tdpt
