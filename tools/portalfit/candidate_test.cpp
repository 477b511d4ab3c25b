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

// Lines of light along x: through a hole of 1 m they widen before and behind it; in a corridor of
// that width, from wall to wall, they do not.
Aperture across_x(bool corridor, LightGrid& grid) {
  grid.voxel = 0.1;
  grid.dim = {200, 200, 200};
  grid.origin = Vec3d(-10);
  for (uint64_t i = 0; i < 4000; ++i) {
    Rng rng(12, 1, i);
    const auto centred = [&] { return rng.uniform() - 0.5; };
    const Vec3d begin{-3, centred(), centred()}, end{3, centred(), centred()};
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3d d = cosine_hemisphere(u, v), w{d.z, d.x, d.y}, p{0, centred(), centred()};
    grid.lines.push_back(corridor ? LightLine{begin, end} : LightLine{p - w * 3, p + w * 3});
  }
  Aperture a;
  a.tube.middle = {{0, 0, 0}, {1, 0, 0}};
  a.polygon = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  a.lines = testing::all_of(grid);
  return a;
}

TEST(Widening, TellsAHoleFromACorridor) {
  LightGrid hole, corridor;
  const Aperture through = across_x(false, hole), along = across_x(true, corridor);
  EXPECT_GT(widening_of({hole, {}}, through).value_or(0), 2);
  EXPECT_NEAR(widening_of({corridor, {}}, along).value_or(0), 1, 0.15);
}

// Under a sky lines begin on the border of the grid, close to the window, but come from far away.
TEST(Widening, OfAWindowGoesOnOutsideTheGrid) {
  LightGrid grid;
  const Aperture window = across_x(false, grid);
  const auto cut_off = [](LightLine& line) {
    const Vec3d d = line.camera - line.light;
    line.light += d * ((-0.2 - line.light.x) / d.x);
    line.camera = line.light + d * (0.3 / d.x);  // and end close behind it
  };
  for (LightLine& line : grid.lines) cut_off(line);
  EXPECT_FALSE(widening_of({grid, {}}, window));  // as by walls
  grid.origin.x = -0.2;
  EXPECT_GT(widening_of({grid, {}}, window).value_or(0), 2);
}

}  // namespace tdpt::candidate_test
