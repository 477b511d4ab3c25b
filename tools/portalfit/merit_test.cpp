// Lines through walls of known thickness, whose tightness has a closed form.

#include <cmath>

#include <gtest/gtest.h>

#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/openings.h"

namespace tdpt::merit_test {

// A square hole of side `a` about (x, 0, 0), light going to +z through a wall of thickness `d`.
std::vector<LightLine> lines_through(double a, double d, size_t n, uint32_t cut, double x = 0) {
  const double h = 0.5 * a;
  return testing::lines_through({{{x, 0, 0}, {h, 0, 0}, {0, h, 0}, {0, 0, 1}, d}}, n, {1}, 3, cut);
}

Portal square(double a, double x = 0) {
  const double h = 0.5 * a;
  Portal p;
  p.vertices = {{x - h, -h, 0}, {x + h, -h, 0}, {x + h, h, 0}, {x - h, h, 0}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.figures = {{"area", a * a}, {"flux_share", 1}};
  return p;
}

// Share of the cosine-distributed lines through a square channel's middle that hit no jamb, by
// Monte Carlo.
double passing(double a, double d) {
  size_t n = 0;
  constexpr size_t kTries = 20000;
  for (uint64_t i = 0; i < kTries; ++i) {
    Rng rng(4, 1, i);
    const double u = rng.uniform(), v = rng.uniform(), s = rng.uniform(), t = rng.uniform();
    const Vec3d w = cosine_hemisphere(s, t);
    const double dx = 0.5 * d * std::abs(w.x / w.z), dy = 0.5 * d * std::abs(w.y / w.z);
    n += std::abs(a * (u - 0.5)) + dx <= 0.5 * a && std::abs(a * (v - 0.5)) + dy <= 0.5 * a;
  }
  return static_cast<double>(n) / kTries;
}

double tightness_of(const std::vector<LightLine>& lines, const Portal& portal) {
  LightGrid grid;
  grid.lines = lines;
  std::vector<Portal> portals{portal};
  appraise(grid, portals);
  EXPECT_FALSE(portals[0].figures.contains("conductance"));  // its cut is unknown
  return portals[0].figures.contains("tightness") ? portals[0].figures.at("tightness") : -1;
}

TEST(Tightness, IsTheShareThatPassesTheWall) {
  for (const double d : {0.0, 0.1, 0.3, 1.0})
    EXPECT_NEAR(tightness_of(lines_through(1, d, 8000, 0), square(1)) / passing(1, d), 1, 0.15)
        << d;
  // A portal twice as wide as the hole passes a quarter of its lines. Also the twin of the above.
  std::vector<LightLine> lines = lines_through(0.5, 0.1, 8000, 0);
  const double loose = tightness_of(lines, square(1)), tight = tightness_of(lines, square(0.5));
  EXPECT_NEAR(loose / (0.25 * passing(0.5, 0.1)), 1, 0.15);
  EXPECT_LT(loose, 0.5 * tight);
  // Lines the other way, and none, tell nothing.
  for (LightLine& l : lines) std::swap(l.light, l.camera);
  EXPECT_EQ(tightness_of(lines, square(0.5)), -1);
  EXPECT_EQ(tightness_of({}, square(0.5)), -1);
}

TEST(Appraise, EachPortalBelongsToItsOwnCut) {
  LightGrid grid;
  grid.lines = lines_through(0.2, 0.1, 4000, 0);
  for (const LightLine& l : lines_through(1, 0.1, 4000, 1, 5)) grid.lines.push_back(l);
  grid.cuts = {{0.001, 0.5}, {0.2, 1}};
  std::vector<Portal> portals{square(0.2), square(1, 5)};
  appraise(grid, portals);
  EXPECT_EQ(portals[0].figures.at("cut"), 0);
  EXPECT_EQ(portals[1].figures.at("cut"), 1);
  EXPECT_NEAR(portals[0].figures.at("conductance"), 0.0005, 1e-5);
  EXPECT_NEAR(portals[1].figures.at("conductance"), 0.2, 1e-3);
}

TEST(Appraise, PortalsOfOneCutCarryItsLightTogether) {
  LightGrid grid;
  grid.lines = lines_through(0.2, 0.1, 4000, 0);
  for (const LightLine& l : lines_through(0.2, 0.1, 4000, 0, 5)) grid.lines.push_back(l);
  grid.cuts = {{0.001, 1}};
  std::vector<Portal> both{square(0.2), square(0.2, 5)}, one{square(0.2)};
  appraise(grid, both);
  appraise(grid, one);
  EXPECT_NEAR(both[0].figures.at("conductance"), 0.001, 1e-9);
  EXPECT_EQ(both[1].figures.at("conductance"), both[0].figures.at("conductance"));
  EXPECT_NEAR(one[0].figures.at("conductance"), 0.0005, 1e-5);
}

// The way is equally narrow whether the cut runs before or behind the jambs.
TEST(Appraise, JambsOnEitherSideOfTheCutMakeNoDifference) {
  LightGrid grid;
  grid.lines = lines_through(0.2, 0.3, 4000, 0);
  grid.cuts = {{0.0005, 1}};
  std::vector<Portal> clear{square(0.2)}, jambs{square(0.2)};
  appraise(grid, clear);
  // As many lines again, which end on a jamb before the middle; the cut carries twice as much.
  for (LightLine l : lines_through(0.2, 0.3, 4000, 0)) {
    l.camera = l.light + (l.camera - l.light) * 0.45;
    grid.lines.push_back(l);
  }
  grid.cuts = {{0.001, 1}};
  appraise(grid, jambs);
  const auto width = [](const Portal& p) {
    return p.figures.at("conductance") / p.figures.at("tightness");
  };
  EXPECT_NEAR(width(jambs[0]), width(clear[0]), 1e-9);
  // Twin: a cut that carries twice as much through the middle is wider.
  grid.lines.resize(4000);
  appraise(grid, jambs);
  EXPECT_GT(width(jambs[0]), 1.9 * width(clear[0]));
}

// A window at z = 0 and a door at z = 0.5 behind it; half of the lines begin at the window's sill.
TEST(Appraise, TheSkyMeetsTheWindowFirst) {
  LightGrid grid;
  grid.origin = {-8, -8, -8};
  grid.dim = {16, 16, 16};
  grid.air.assign(16 * 16 * 16, 1);
  grid.air[0] = 0;
  for (const LightLine& l : lines_through(1, 0.1, 2000, 0)) {
    const Vec3d d = l.camera - l.light;
    LightLine line = l;
    line.light = l.light - d * ((l.light.z - -8) / d.z);  // the plane of the grid's border
    const auto inside = [](double v) { return std::abs(v) < 8; };
    if (!inside(line.light.x) || !inside(line.light.y)) continue;
    grid.lines.push_back(line);
    grid.lines.push_back(l);
  }
  Portal door = square(1);
  for (Vec3d& v : door.vertices) v.z = 0.5;
  const auto sky_of = [&](const std::string& scene, std::vector<Portal> portals) {
    grid.scene_hash = scene;
    appraise(grid, portals);
    std::vector<double> sky;
    for (const Portal& p : portals)
      sky.push_back(p.figures.contains("sky") ? p.figures.at("sky") : -1);
    return sky;
  };
  const std::vector<double> both = sky_of("a+b", {square(1), door});
  EXPECT_NEAR(both[0], 0.5, 0.01);
  EXPECT_EQ(both[1], 0);
  EXPECT_NEAR(sky_of("a+b", {door})[0], 0.5, 0.01);  // where the window was not found
  EXPECT_EQ(sky_of("a", {square(1)})[0], 0);         // without a sky
  EXPECT_EQ(sky_of("", {square(1)})[0], -1);         // unknown
  grid.air[0] = 1;
  EXPECT_EQ(sky_of("a+b", {square(1)})[0], -1);
}

}  // namespace tdpt::merit_test
