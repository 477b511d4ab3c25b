#include "tools/portalfit/report.h"

#include <gtest/gtest.h>

namespace tdpt::report_test {

Portal portal(double area, double share) {
  Portal p;
  p.figures = {{"area", area}, {"flux_share", share}, {"tightness", 0.9}, {"conductance", 0.01}};
  return p;
}

TEST(portalfit_report, portals_are_one_line_however_many_there_are) {
  EXPECT_EQ(portals_sentence({portal(0.694, 0.742)}), "1 portal: portal.0 0.69 m2");
  EXPECT_EQ(portals_sentence({portal(0.69, 0.74), portal(2, 0.1)}),
            "2 portals: portal.0 0.69 m2, portal.1 2 m2");
  EXPECT_EQ(portals_sentence(std::vector<Portal>(9, portal(1, 0.1))),
            "9 portals: portal.0 1 m2, portal.1 1 m2, portal.2 1 m2, and 6 more");
  Portal wide = portal(1, 0.5);
  wide.figures["conductance"] = 0.2;
  EXPECT_NE(portals_sentence({wide}).find("m2 (a wide way, "), std::string::npos);
}

}  // namespace tdpt::report_test
