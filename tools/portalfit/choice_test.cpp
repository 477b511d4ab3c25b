#include "tools/portalfit/choice.h"

#include <gtest/gtest.h>

namespace tdpt::choice_test {

Portal portal(double conductance) {
  Portal p;
  p.figures = {{"conductance", conductance}};
  return p;
}

std::vector<bool> useless(const std::vector<Portal>& portals) {
  std::vector<bool> result;
  for (const std::string& why : why_useless(portals, {})) result.push_back(!why.empty());
  return result;
}

TEST(Choice, AWayAsWideAsARoomIsUseless) {
  EXPECT_EQ(useless({portal(0.3), portal(0.15)}), (std::vector<bool>{true, false}));
}

TEST(Choice, WhatIsUnknownSaysNothing) {
  Portal keyhole;
  keyhole.figures = {{"tightness", 0.0004}};
  EXPECT_EQ(useless({Portal{}, keyhole}), (std::vector<bool>{false, false}));
}

}  // namespace tdpt::choice_test
