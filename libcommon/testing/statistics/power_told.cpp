// power_told: computes the required sample sizes of tests from their output with many seeds
// (power.sh).
//
// stdin: the output of GoogleTest programs run with TDPT_SEED. stdout: for each test and each of
// its verdicts that detected a fault, the question that detects it with the fewest samples, and
// their number.
#include <cmath>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "libcommon/testing/statistics/power.h"

namespace tdpt::testing {
namespace {

/// Sums over seeds.
struct Answer {
  double n = 0, samples = 0, z = 0, freedom = 0, rms_squared = 0, tested = 0, least = 0;
  size_t verdict = 0;
};

struct Told {
  double enough = HUGE_VAL;
  std::string text;
};

Told told(const Answer& a) {
  const Question q{a.least / a.n, kPower};
  const double z = std::abs(a.z / a.n), rms = std::sqrt(a.rms_squared / a.n), at = a.samples / a.n;
  const auto blocks = static_cast<size_t>(std::lround(a.tested / a.n));
  double by_drift = HUGE_VAL, by_rms = HUGE_VAL;
  if (z > 3) by_drift = samples_by_drift(at, std::min(z, 36.0), a.freedom / a.n, q);
  if (blocks > 0 && rms > 1.5) by_rms = samples_by_rms(at, rms, blocks, q);
  std::ostringstream text;
  text.precision(3);
  text << "of " << at << " drift z " << z << ", rms z " << rms << " of " << blocks
       << " blocks: " << std::min(by_drift, by_rms) << " by "
       << (by_drift < by_rms ? "drift" : "rms");
  return {std::min(by_drift, by_rms), text.str()};
}

void run() {
  std::map<std::string, std::vector<Answer>> tests;
  std::vector<Answer>* test = nullptr;
  size_t next = 0, verdict = 0;
  const std::string begins = "[ RUN      ] ";
  for (std::string line; std::getline(std::cin, line);) {
    if (line.starts_with(begins)) test = &tests[line.substr(begins.size())], next = verdict = 0;
    std::istringstream words(line);
    std::string first;
    int k;
    double samples, z, freedom, rms, tested, least;
    words >> first >> k >> samples >> z >> freedom >> rms >> tested >> least;
    if (!words || first != "answer" || !test) continue;
    if (next == test->size()) test->emplace_back();
    Answer& a = (*test)[next++];
    a.verdict = k == 0 ? ++verdict : verdict;
    a.n += 1, a.samples += samples, a.z += z, a.freedom += freedom, a.least += least;
    a.rms_squared += rms * rms, a.tested += tested;
  }
  for (const auto& [name, answers] : tests)
    for (size_t v = 1, i = 0; i < answers.size(); ++v) {
      Told best;
      for (; i < answers.size() && answers[i].verdict == v; ++i)
        if (Told now = told(answers[i]); now.enough < best.enough) best = now;
      if (best.enough < HUGE_VAL)
        std::cout << name << ", verdict " << v << ": " << best.text << '\n';
    }
}

}  // namespace
}  // namespace tdpt::testing

int main() {
  tdpt::testing::run();
}
