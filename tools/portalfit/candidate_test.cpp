#include "tools/portalfit/candidate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "tools/portalfit/test_bundle.h"

namespace tdpt::candidate_test {

// Windows 1 m high and 1 m wide, kPier from the z axis on either side, leaning back from the plane
// across x by `angle`; and the plane across the mouth between their far sides. Probes pass anywhere
// there; lines, and probes that join, pass a window.
constexpr double kPier = 0.7, kFar = kPier + 1;

struct Bay {
  explicit Bay(double angle);
  Bay(const Bay&) = delete;  // bundles refer to the grid
  LightGrid grid;
  Bundle all;
  Aperture mouth;
};

bool through_window(const LightLine& line, double side, double angle) {
  const Vec3d along{-std::sin(angle), side * std::cos(angle), 0};
  const Vec3d n{std::cos(angle), side * std::sin(angle), 0};
  const Vec3d d = line.camera - line.light;
  if (!(dot(d, n) > 0)) return false;
  const Vec3d p = line.light - d * (dot(line.light, n) / dot(d, n));
  return dot(p, along) >= kPier && dot(p, along) <= kFar && std::abs(p.z) <= 0.5;
}

Bay::Bay(double angle) {
  grid.voxel = 0.05;
  grid.dim = {160, 160, 160};
  grid.origin = Vec3d(-4);
  grid.count.assign(size_t{160} * 160 * 160, 0);
  const double half = kFar * std::cos(angle), deep = -kFar * std::sin(angle);
  for (uint64_t i = 0; grid.lines.size() < 6000; ++i) {
    Rng rng(11, 1, i);
    const double y = 2.5 * (2 * rng.uniform() - 1), z = 1.5 * (2 * rng.uniform() - 1);
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3d d = cosine_hemisphere(u, v), w{d.z, d.x, d.y}, p{0.5 * deep, y, z};
    const LightLine line{p - w * 3, p + w * 3};
    const bool joins = through_window(line, 1, angle) || through_window(line, -1, angle);
    grid.probes.push_back({line, joins});
    if (joins) grid.lines.push_back(line);
  }
  all = testing::all_of(grid);
  mouth.tube.middle = {{deep, 0, 0}, {1, 0, 0}};
  for (const auto& [y, z] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}})
    mouth.polygon.push_back(in_plane(mouth.tube.middle, Vec3d{deep, y * half, z * 0.5}));
  mouth.polygon = convex_hull(mouth.polygon);
  mouth.lines = lines_across(all, mouth);
}

TEST(Candidate, OneWindowOfABayIsDenserThanItsMouth) {
  constexpr double kAngle = std::numbers::pi / 6;
  const Bay b(kAngle);
  const auto part = denser_part({b.grid, {}}, b.all, b.mouth);
  ASSERT_TRUE(part);
  EXPECT_NEAR(area(part->polygon), 1, 0.1);
  EXPECT_NEAR(part->tube.middle.n.x, std::cos(kAngle), 0.05);
}

// Twin: a single window has no denser part.
TEST(Candidate, APartOfOneOpeningIsNotDenser) {
  const Bay b(std::numbers::pi / 6);
  const auto window = denser_part({b.grid, {}}, b.all, b.mouth);
  ASSERT_TRUE(window);
  EXPECT_FALSE(denser_part({b.grid, {}}, b.all, *window));
}

// A square of 1 m across x, with walls around it: of a corridor from -2 to 2 m, or of a hole in a
// wall that is 0.2 m thick.
Aperture across_x(double from, double to, LightGrid& grid) {
  grid.voxel = 0.1;
  grid.dim = {40, 40, 40};
  grid.origin = Vec3d(-2);
  grid.air.assign(64000, 1);
  for (size_t v = 0; v < grid.air.size(); ++v) {
    const Vec3d at = centre_of(grid, v);
    const double off = std::max(std::abs(at.y), std::abs(at.z));
    if (at.x > from && at.x < to && off > 0.5 && off < 0.75) grid.air[v] = 0;
  }
  Aperture a;
  a.tube.middle = {{0, 0, 0}, {1, 0, 0}};
  a.polygon = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  return a;
}

TEST(Edge, TellsAHoleFromACorridor) {
  LightGrid hole, corridor, end;
  const Aperture through = across_x(-0.1, 0.1, hole), along = across_x(-2, 2, corridor),
                 out_of = across_x(-2, 0.1, end);
  EXPECT_EQ(edge_share({hole, {}}, through).value_or(0), 1);
  EXPECT_EQ(edge_share({corridor, {}}, along).value_or(1), 0);
  EXPECT_EQ(edge_share({end, {}}, out_of).value_or(0), 1);  // on one side
  // A door in the corridor's wall is not enough.
  for (size_t v = 0; v < corridor.air.size(); ++v) {
    const Vec3d at = centre_of(corridor, v);
    if (at.x > 0.2 && at.y > 0.5 && std::abs(at.z) < 0.4) corridor.air[v] = 1;
  }
  EXPECT_NEAR(edge_share({corridor, {}}, along).value_or(1), 0.2, 0.05);
  // Nor is a place in the open.
  const Aperture apart{{{{1, 0, 0}, {1, 0, 0}}}, through.polygon, {}};
  EXPECT_EQ(edge_share({hole, {}}, apart).value_or(1), 0);
  corridor.voxel = 0.3;  // too coarse to tell
  EXPECT_FALSE(edge_share({corridor, {}}, along));
  corridor.voxel = 0.1;
  corridor.air.assign(corridor.air.size(), 1);
  EXPECT_FALSE(edge_share({corridor, {}}, along));
}

// Beyond the grid, as under a sky, all is open.
TEST(Edge, OfAWindowGoesOnOutsideTheGrid) {
  LightGrid grid;
  const Aperture window = across_x(-2, 2, grid);
  grid.origin.x = 0;
  EXPECT_EQ(edge_share({grid, {}}, window).value_or(0), 1);
}

}  // namespace tdpt::candidate_test
