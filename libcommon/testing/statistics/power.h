// How large a statistical test is: the fewest samples that see the fault planted in its twin all
// but always, where what is right is called wrong all but never. Both are asked of the distribution
// that the statistic has with the fault and without it [z_test.h]:
//   drift   Student's t, which a fault moves by a number of standard errors that grows with the
//           square root of the samples
//   rms z   chi-square of the blocks, whose noncentrality grows with the samples
// `make test-long` asks families of tests with 200 fresh seeds how often they fail, and prints how
// many samples would do (power.sh).
#pragma once
#include <cstddef>
#include <cstdint>

#include "libcommon/testing/statistics/z_test.h"

namespace tdpt::testing {

/// Of a test as a whole, however many questions it asks.
inline constexpr double kFalseAlarm = 1e-5;
/// Probability to see the fault.
inline constexpr double kPower = 0.999;

/// A question: how probable an answer must be by chance not to be an alarm.
struct Question {
  double least = kFalseAlarm;
  double power = kPower;
};

/// How far t must be off in the mean, in standard errors.
double least_shift(double freedom, const Question& = {});
/// How large the noncentrality must be.
double least_noncentrality(size_t blocks, const Question& = {});

/// The fewest samples where `samples` gave this z in the mean: one of t's, of so many degrees of
/// freedom, as of a normal distribution.
double samples_by_drift(double samples, double z, double freedom, const Question& = {});
/// The same where the rms over `blocks` of z was this.
double samples_by_rms(double samples, double rms_z, size_t blocks, const Question& = {});

/// This seed, or in the environment of TDPT_SEED=1, 2, ... another one for each: tests of random
/// numbers are the same in each run but for those that ask how often they fail (power.sh).
uint64_t fresh(uint64_t seed);
/// There, the k-th answer of a verdict, from so many samples, is printed for power_told.cpp.
void tell_answer(const Agreement& agreement, uint64_t samples, size_t k = 0);

}  // namespace tdpt::testing
