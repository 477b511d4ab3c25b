// Few of many: of terms of a sum, those that are worth a ray.
//
// Method: systematic sampling with given chances. Each term has an estimate e_i; its chance is
// c_i = min(1, k e_i), k such that the chances add up to the number that is wanted. The sum over
// those that are taken of term / chance has no bias, whatever the estimates.
#pragma once
#include <span>
#include <vector>

namespace tdpt {

class Few {
 public:
  void clear() { estimates_.clear(); }
  /// Of the next term; 0: it is never taken.
  void add(double estimate) { estimates_.push_back(estimate); }

  struct Taken {
    size_t term;    ///< in the order that they were added
    double chance;  ///< that it was taken
  };
  /// Takes `count` of the terms, or all that are not 0 if those are not more. u in [0,1).
  std::span<const Taken> choose(int count, double u);

 private:
  std::vector<double> estimates_;
  std::vector<Taken> taken_;
};

}  // namespace tdpt
