#include "libcommon/cli/cli.h"

#include <gtest/gtest.h>

#include "libcommon/base/process.h"

namespace tdpt::cli::common_test {

TEST(decision, is_one_line_with_its_reason_and_its_price) {
  EXPECT_EQ(sentence({"alpha", "left out", "no material has any", "no ray asks"}),
            "alpha: left out, because no material has any (no ray asks)");
  EXPECT_EQ(sentence({"alpha", "used", "2 of 3 materials have some", ""}),
            "alpha: used, because 2 of 3 materials have some");
}

TEST(decision, price_is_the_cpu_time_of_the_phases_named) {
  Phases phases;
  volatile double sum = 0;
  for (int i = 0; i < 20000000; ++i) sum = sum + 1;
  phases.done("work");
  phases.done("rest");
  const double of_work = std::stod(price_of(phases, {"work"}));
  EXPECT_GT(of_work, 0.001);
  EXPECT_LT(std::stod(price_of(phases, {"rest"})), 0.5 * of_work);
  EXPECT_EQ(price_of(9.99), "10 CPU s");
}

TEST(decision, is_not_thought_of_unless_asked_for) {
  Common common;
  size_t asked = 0;
  const auto decisions = [&] {
    ++asked;
    return Decisions{};
  };
  common.explain_by(decisions);
  EXPECT_EQ(asked, 0u);
  common.explain = common.quiet = true;
  common.explain_by(decisions);
  EXPECT_EQ(asked, 1u);
}

}  // namespace tdpt::cli::common_test
