#include "libcommon/formats/portal_worth.h"

#include <gtest/gtest.h>

namespace tdpt::portal_worth_test {

TEST(Drawback, IsWhatTheFiguresSayAgainstAPortal) {
  EXPECT_EQ(drawback_of({}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.05}, {"conductance", 0.08}}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.001}}),
            "0.1 % of the lines through it pass from one side to the other");
  EXPECT_EQ(drawback_of({{"tightness", 1}, {"conductance", 0.2}}),
            "a wide way, 20 % of the smaller side's light finds it alone");
  EXPECT_EQ(drawback_of({{"conductance", 1}}),
            "a wide way, 100 % of the smaller side's light finds it alone");
}

// Only figures, no statement about a picture.
TEST(WorthSentence, SaysWhatIsKnown) {
  EXPECT_EQ(worth_sentence({}, 0.25), "0.25 m2");
  EXPECT_EQ(worth_sentence({}, 23456), "23460 m2");
  EXPECT_EQ(worth_sentence({{"area", 0.0625}, {"tightness", 0.71}, {"conductance", 0.0021}}, 9),
            "0.0625 m2, tightness 0.71, conductance 0.0021");
  EXPECT_EQ(worth_sentence({{"conductance", 0.2}}, 1),
            "1 m2, conductance 0.2: a wide way, 20 % of the smaller side's light finds it alone");
}

}  // namespace tdpt::portal_worth_test
