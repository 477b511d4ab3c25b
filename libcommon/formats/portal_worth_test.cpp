#include "libcommon/formats/portal_worth.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tdpt {
namespace {

using Figures = std::map<std::string, double>;

// Never less for a narrower opening, a tighter portal, or one that carries more of the light.
template <class Gain>
bool monotone(const Gain& gain) {
  const double steps[] = {0, 1e-6, 1e-4, 0.001, 0.01, 0.1, 0.3, 0.6, 1};
  for (const double a : steps)
    for (const double b : steps)
      for (size_t i = 0; i + 1 < std::size(steps); ++i) {
        const double low = steps[i], high = steps[i + 1];
        if (gain(low, a, b) > gain(high, a, b)) return false;
        if (gain(a, low, b) > gain(a, high, b)) return false;
        if (gain(a, b, low) < gain(a, b, high)) return false;
      }
  return true;
}

TEST(ExpectedGain, GrowsWithShareAndTightnessAndFallsWithConductance) {
  EXPECT_TRUE(monotone(expected_gain));
  // Twins: the check sees a law that forgets to be monotone in one of the three.
  EXPECT_FALSE(monotone([](double s, double t, double c) { return expected_gain(1 - s, t, c); }));
  EXPECT_FALSE(monotone([](double s, double t, double c) { return expected_gain(s, 1 - t, c); }));
  EXPECT_FALSE(monotone([](double s, double t, double c) { return expected_gain(s, t, 1 - c); }));
}

TEST(ExpectedGain, IsFiniteWhateverTheFiguresSay) {
  for (const double v : {-1.0, 0.0, 1e-300, 1.0, 2.0, 1e300})
    for (const double w : {-1.0, 0.0, 1.0, 1e300}) {
      EXPECT_TRUE(std::isfinite(expected_gain(v, w, w)));
      EXPECT_TRUE(std::isfinite(expected_gain(w, w, v)));
      EXPECT_GT(expected_gain(w, v, w), 0);
    }
}

TEST(ExpectedGain, KnowsAHoleFromAnOpenPlan) {
  EXPECT_GT(expected_gain(0.98, 0.7, 0.0002), 3);
  EXPECT_LT(expected_gain(0.98, 0.95, 0.12), kNoGain);
  EXPECT_LT(expected_gain(0.02, 0.9, 0.0002), kNoGain);
}

TEST(Verdict, SaysWhatAPortalIsWorth) {
  EXPECT_EQ(verdict_of({{"expected_gain", 1.5}}).words, "useful");
  EXPECT_EQ(verdict_of({{"expected_gain", 1.2}}).words, "little gain");
  EXPECT_EQ(verdict_of({{"expected_gain", 0.8}, {"flux_share", 0.02}}).words,
            "useless: it carries 2 % of the light");
  EXPECT_EQ(verdict_of({{"expected_gain", 0.8}, {"tightness", 0.001}}).words,
            "useless: 0.1 % of the lines through it pass from one side to the other");
  EXPECT_EQ(verdict_of(
                {{"expected_gain", 0.8}, {"flux_share", 1}, {"tightness", 1}, {"conductance", 0.2}})
                .words,
            "useless: a wide way, 20 % of the smaller side's light finds it alone");
  EXPECT_EQ(verdict_of({{"expected_gain", 0.8}}).words, "useless: it costs more than it gains");
  EXPECT_EQ(verdict_of({}).words, "worth unknown");
}

TEST(WorthSentence, SaysWhatIsKnown) {
  EXPECT_EQ(worth_sentence({}, 0.25), "0.25 m2: worth unknown");
  EXPECT_EQ(
      worth_sentence(
          {{"area", 0.0625}, {"flux_share", 0.98}, {"tightness", 0.71}, {"expected_gain", 2.7}}, 9),
      "0.0625 m2, 98.0 % of the light, tightness 0.71, expected gain 2.7: useful");
}

}  // namespace
}  // namespace tdpt
