#include "tools/portalfit/choice.h"

#include <gtest/gtest.h>

namespace tdpt::choice_test {

Portal portal(double cut, double share, double conductance) {
  Portal p;
  p.figures = {{"cut", cut}, {"flux_share", share}, {"conductance", conductance}};
  return p;
}

std::vector<bool> useless(const std::vector<Portal>& portals) {
  std::vector<bool> result;
  for (const std::string& why : why_useless(portals)) result.push_back(!why.empty());
  return result;
}

TEST(Choice, PortalsOfACutAreJudgedTogether) {
  const Portal window = portal(0, 0.04, 0.01), leak = portal(1, 0.04, 0.01);
  EXPECT_EQ(useless({window, window, window, leak}),
            (std::vector<bool>{false, false, false, true}));
  // Twin: one window alone carries next to nothing.
  EXPECT_EQ(useless({window, leak}), (std::vector<bool>{true, true}));
}

TEST(Choice, AWayAsWideAsARoomIsUseless) {
  EXPECT_EQ(useless({portal(0, 1, 0.3), portal(1, 1, 0.15)}), (std::vector<bool>{true, false}));
}

TEST(Choice, WhatIsUnknownSaysNothing) {
  Portal keyhole;
  keyhole.figures = {{"tightness", 0.0004}};
  EXPECT_EQ(useless({Portal{}, keyhole}), (std::vector<bool>{false, false}));
}

}  // namespace tdpt::choice_test
