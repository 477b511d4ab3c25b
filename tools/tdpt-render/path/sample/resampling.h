// Chooses the terms of a sum that are worth a ray: resampling without bias.
//
// Method: systematic sampling with given probabilities. Each term has an estimate e_i and is chosen
// with probability c_i = min(1, k e_i), k such that the c_i sum to the number wanted. The sum over
// the chosen terms of term / c_i is unbiased for any positive estimates.
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
  /// Adds the estimate of the next term; 0: it is never chosen. Branch-free: many are 0, and which
  /// cannot be predicted.
  void add(double estimate) {
    terms_[not_zero_] = {added_++, estimate};
    not_zero_ += estimate != 0;
  }

  struct Taken {
    size_t term;    ///< in the order of adding
    double chance;  ///< probability that it was chosen
  };
  /// Chooses `count` terms, or all that are not 0 if there are no more. u in [0,1).
  std::span<const Taken> choose(uint32_t count, double u);

 private:
  struct Term {
    size_t number;  // in the order of adding
    double estimate;
  };
  std::span<const Term> terms() const { return {terms_.data(), not_zero_}; }
  double factor(uint32_t count) const;

  std::vector<Term> terms_;  // the first not_zero_ are in use
  size_t added_ = 0, not_zero_ = 0;
  std::vector<Taken> taken_;
};

}  // namespace tdpt
