#include "tools/portalfit/portalfit.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tdpt::paper_test {

// Full voxels in a box of nx x ny x nz, light along +x.
LightGrid grid_with_box(int nx, int ny, int nz) {
  LightGrid g;
  g.voxel = 0.1;
  g.dim = {16, 16, 16};
  g.count.assign(16 * 16 * 16, 0);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) g.count[g.index(2 + i, 3 + j, 4 + k)] = 10;
  g.count[g.index(15, 15, 15)] = 4;  // not full
  g.lines = {{{0, 0.5, 0.6}, {1.6, 0.5, 0.6}, 0}};
  return g;
}

TEST(PortalByPaper, IsTheHullAcrossALongBeam) {
  const auto portal = portal_by_paper(grid_with_box(10, 3, 4));
  ASSERT_EQ(portal.portals.size(), 1u);
  EXPECT_NEAR(portal.portals[0].figures.at("area"), 0.2 * 0.3, 1e-9);
  EXPECT_NEAR(portal.portals[0].figures.at("flux_share"), 1, 1e-12);
  EXPECT_EQ(portal.lines[0], std::vector<uint32_t>{0});
  EXPECT_NEAR(portal.portals[0].figures.at("direction_angle"), 0, 1e-6);
  for (const Vec3d& v : portal.portals[0].vertices) EXPECT_NEAR(v.x, 0.25, 1e-9);
  // Turned round if the light is.
  LightGrid turned = grid_with_box(10, 3, 4);
  std::swap(turned.lines[0].light, turned.lines[0].camera);
  const auto back = portal_by_paper(turned);
  ASSERT_EQ(back.portals.size(), 1u);
  const auto normal_x = [](const Portal& p) {
    const auto& t = p.triangles[0];
    return cross(p.vertices[t[1]] - p.vertices[t[0]], p.vertices[t[2]] - p.vertices[t[0]]).x;
  };
  EXPECT_GT(normal_x(portal.portals[0]), 0);
  EXPECT_LT(normal_x(back.portals[0]), 0);
}

// A beam that spreads behind the opening: the plane through the fullest voxel passes the narrow
// part, and what is full elsewhere does not count.
TEST(PortalByPaper, IsMadeOfTheVoxelsThatThePlaneIntersects) {
  LightGrid g = grid_with_box(10, 3, 4);
  for (int k = 3; k <= 8; ++k)
    for (int j = 2; j <= 6; ++j) g.count[g.index(9, j, k)] = 10;
  g.count[g.index(5, 4, 5)] = 12;
  const auto portal = portal_by_paper(g);
  ASSERT_EQ(portal.portals.size(), 1u);
  EXPECT_NEAR(portal.portals[0].figures.at("area"), 0.2 * 0.3, 1e-9);
  for (const Vec3d& v : portal.portals[0].vertices) EXPECT_NEAR(v.x, 0.55, 1e-9);
  // Twin: with the fullest voxel where it is broad, so is the portal.
  g.count[g.index(9, 4, 5)] = 13;
  EXPECT_NEAR(portal_by_paper(g).portals.at(0).figures.at("area"), 0.4 * 0.5, 1e-9);
}

// Its known weakness: where the full voxels lie flat in the opening, the portal is perpendicular to
// it.
TEST(PortalByPaper, StandsAcrossFlatOnes) {
  const auto portal = portal_by_paper(grid_with_box(2, 10, 4));
  ASSERT_EQ(portal.portals.size(), 1u);
  EXPECT_NEAR(portal.portals[0].figures.at("direction_angle"), 90, 1e-6);
}

TEST(PortalByPaper, NeedsAPolygon) {
  EXPECT_TRUE(portal_by_paper(grid_with_box(10, 1, 1)).portals.empty());
  EXPECT_TRUE(portal_by_paper(LightGrid{}).portals.empty());
  // A plane of voxels seen edge-on is a line, apart from rounding.
  LightGrid row = grid_with_box(9, 4, 1);
  row.origin = {0.1, 0.7, 0.3};
  EXPECT_TRUE(portal_by_paper(row).portals.empty());
}

}  // namespace tdpt::paper_test
