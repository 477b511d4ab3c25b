// Sample size of a statistical test: the fewest samples with which it detects the fault planted in
// its twin with probability kPower, and raises a false alarm with at most kFalseAlarm. Both follow
// from the distribution of the statistic with and without the fault [z_test.h]:
//   drift   Student's t, shifted by the fault by a number of standard errors that grows with the
//           square root of the samples
//   rms z   chi-square of the blocks, whose noncentrality grows with the samples
// `make test-long` runs families of tests with 200 fresh seeds, counts their failures, and prints
// how many samples would suffice (power.sh).
#pragma once
#include <cstddef>
#include <cstdint>

#include "libcommon/testing/statistics/z_test.h"

namespace tdpt::testing {

/// For a test as a whole, however many questions it asks.
inline constexpr double kFalseAlarm = 1e-5;
/// Probability of detecting the fault.
inline constexpr double kPower = 0.999;

/// One of a test's questions: the p-value below which it raises an alarm.
struct Question {
  double least = kFalseAlarm;
  double power = kPower;
};

/// Required mean shift of t, in standard errors.
double least_shift(double freedom, const Question& = {});
/// Required noncentrality.
double least_noncentrality(size_t blocks, const Question& = {});

/// The fewest samples, given that `samples` samples gave this mean z, derived from a t with so many
/// degrees of freedom.
double samples_by_drift(double samples, double z, double freedom, const Question& = {});
/// The same, given this rms of z over `blocks`.
double samples_by_rms(double samples, double rms_z, size_t blocks, const Question& = {});

/// `seed` itself, or with TDPT_SEED=1, 2, ... in the environment a different one for each: tests
/// use the same random numbers in every run, except when power.sh counts their failures.
uint64_t fresh(uint64_t seed);
/// In such a run, prints the k-th result of a test with so many samples for power_told.cpp.
void tell_answer(const Agreement& agreement, uint64_t samples, size_t k = 0);

}  // namespace tdpt::testing
