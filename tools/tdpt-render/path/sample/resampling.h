// Resampling of many: of terms of a sum, those that are worth a ray.
//
// Method: systematic sampling with given chances. Each term has an estimate e_i; its chance is
// c_i = min(1, k e_i), k such that the chances add up to the number that is wanted. The sum over
// those that are taken of term / chance has no bias, whatever the estimates.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace tdpt {

class Resampling {
 public:
  /// At most so many terms will be added.
  void clear(size_t most) {
    if (terms_.size() < most + 1) terms_.resize(most + 1);
    added_ = not_zero_ = 0;
  }
  /// Of the next term; 0: it is never taken. Many are 0, and nobody foresees which: they are passed
  /// over without a jump.
  void add(double estimate) {
    terms_[not_zero_] = {added_++, estimate};
    not_zero_ += estimate != 0;
  }

  struct Taken {
    size_t term;    ///< in the order that they were added
    double chance;  ///< that it was taken
  };
  /// Takes `count` of the terms, or all that are not 0 if those are not more. u in [0,1).
  std::span<const Taken> choose(uint32_t count, double u);

 private:
  struct Term {
    size_t number;  // in the order that they were added
    double estimate;
  };
  std::span<const Term> terms() const { return {terms_.data(), not_zero_}; }
  double factor(uint32_t count) const;

  std::vector<Term> terms_;  // the first not_zero_ of them
  size_t added_ = 0, not_zero_ = 0;
  std::vector<Taken> taken_;
};

}  // namespace tdpt
