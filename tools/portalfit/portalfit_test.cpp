// Light grids of rooms with known openings.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "tools/portalfit/testing/openings.h"

namespace tdpt::portalfit_test {

using testing::grid_of;
using testing::Light;
using testing::lines_through;
using testing::Opening;

constexpr double kDegrees = 180 / std::numbers::pi;

// All is air but the wall around the openings.
LightGrid in_a_wall(LightGrid grid, const std::vector<Opening>& openings) {
  grid.air.assign(grid.count.size(), 1);
  grid.air[0] = 0;  // there are walls somewhere
  for (size_t v = 0; v < grid.air.size(); ++v) {
    const Vec3d at = centre_of(grid, v);
    const double off = openings.empty() ? grid.voxel : dot(at - openings[0].middle, openings[0].n);
    if (std::abs(off) < grid.voxel)
      grid.air[v] = std::any_of(openings.begin(), openings.end(), [&](const Opening& o) {
        return o.passes({at - o.n, at + o.n}, 0);
      });
  }
  return grid;
}

// Score of a portal for an opening: share of fresh lines through the opening that cross the portal
// along its normal, area of the opening over that of the portal, angle between the normals.
struct Score {
  double coverage = 0, tightness = 0, angle = 180;
};

Vec3d area_vector(const Portal& p) {
  Vec3d sum{};
  for (const auto& t : p.triangles)
    sum += cross(p.vertices[t[1]] - p.vertices[t[0]], p.vertices[t[2]] - p.vertices[t[0]]) * 0.5;
  return sum;
}

bool crosses(const Portal& portal, const LightLine& line) {
  for (const auto& t : portal.triangles) {
    const Vec3d &a = portal.vertices[t[0]], &b = portal.vertices[t[1]], &c = portal.vertices[t[2]];
    const Vec3d n = cross(b - a, c - a), d = line.camera - line.light;
    if (dot(d, n) <= 0) continue;
    const double s = dot(a - line.light, n) / dot(d, n);
    if (s < 0 || s > 1) continue;
    const Vec3d p = line.light + d * s;
    if (dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
        dot(cross(a - c, p - c), n) >= 0)
      return true;
  }
  return false;
}

Score score(const Portal& portal, const Opening& opening, const Light& light = {}) {
  Light clean = light;
  clean.strays = 0;
  const auto fresh = lines_through({opening}, 2000, clean, 999);
  Score s;
  double through = 0;
  for (const LightLine& line : fresh) through += crosses(portal, line);
  s.coverage = through / static_cast<double>(fresh.size());
  const Vec3d a = area_vector(portal);
  s.tightness = opening.area() / length(a);
  s.angle = kDegrees * std::acos(std::clamp(dot(normalize(a), opening.n), -1.0, 1.0));
  return s;
}

Opening hole(double half = 0.25, double thickness = 0.1) {
  return {{1, 2, 3}, {0, half, 0}, {0, 0, half}, {1, 0, 0}, thickness, 1};
}

struct Case {
  const char* name;
  Opening opening = hole();
  Light light{};
  int resolution = 64;
  double most_degrees = 3;
  size_t lines = 4000;
};

TEST(PortalFit, FindsAnOpening) {
  const Vec3d n = normalize(Vec3d{0.3, -0.8, 0.5});
  const Onb<double> frame(n);
  const Opening turned{{100, -200, 50}, frame.x * 30.0, frame.y * 12.0, n, 3};
  const Opening slit{{0, 0, 0}, {0, 0.01, 0}, {0, 0, 0.5}, {1, 0, 0}, 0.01};
  for (const Case& c : std::vector<Case>{{"a hole"},
                                         {"few lines", hole(), {}, 64, 6, 400},
                                         {"in a thick wall", hole(0.25, 0.5)},
                                         {"a slit thinner than a voxel", slit, {}, 48, 5},
                                         {"a grid of one voxel", hole(), {}, 1, 6},
                                         {"light from one side", hole(), {2, 0.9, 0}},
                                         {"strays", hole(), {2, 0, 0.03}},
                                         {"turned, of another size", turned, {200, 0, 0}}}) {
    SCOPED_TRACE(c.name);
    const FitResult fit =
        fit_portals(grid_of(lines_through({c.opening}, c.lines, c.light), c.resolution), {});
    ASSERT_EQ(fit.portals.size(), 1u);
    const Portal& portal = fit.portals[0];
    const Score s = score(portal, c.opening, c.light);
    EXPECT_GT(s.coverage, c.lines < 4000 ? 0.9 : 0.97);
    EXPECT_GT(s.tightness, 0.9);
    EXPECT_LT(s.angle, c.most_degrees);
    EXPECT_LE(portal.vertices.size(), 12u);
    EXPECT_NEAR(portal.figures.at("area") / length(area_vector(portal)), 1, 1e-9);
    const Opening& o = c.opening;
    for (const Vec3d& v : portal.vertices)  // in the middle of its wall
      EXPECT_NEAR(dot(v - o.middle, o.n), 0, 0.2 * std::max(length(o.u), length(o.v)));
    // The mean direction alone would be far off; the waist corrects it.
    EXPECT_EQ(portal.figures.at("direction_angle") > 10, c.light.lean > 0);
  }
}

// Cuts of two cameras, "hall" and "yard": `through` holds the openings that the light of each cut
// passes.
LightGrid grid_of_cameras(const std::vector<std::vector<Opening>>& through) {
  std::vector<LightLine> lines;
  for (uint32_t cut = 0; cut < through.size(); ++cut)
    for (const LightLine& line : lines_through(through[cut], 4000, {}, 1 + cut, cut))
      lines.push_back(line);
  LightGrid grid = grid_of(lines);
  grid.cameras = {"0 0 0 0 0 -1 0 1 0 0.9 1.5 all hall", "1 0 0 0 0 -1 0 1 0 0.9 1.5 all yard"};
  grid.cuts = {{0.01, 1, 0}, {0.01, 1, 1}};
  return grid;
}

// Of two windows in one wall the first brings the hall most of its light, the second the yard all.
TEST(PortalFit, ListsTheCamerasThatEachPortalServes) {
  Opening a = hole(0.2), b = hole(0.2);
  b.middle.z += 0.8;
  a.share = 0.9, b.share = 0.1;
  Opening alone = b;
  alone.share = 1;
  LightGrid grid = grid_of_cameras({{a, b}, {alone}});
  const FitResult fit = fit_portals(grid, {});
  ASSERT_EQ(fit.portals.size(), 2u);
  const Portal &of_b = fit.portals[0], &of_a = fit.portals[1];
  ASSERT_EQ(of_a.cameras.size(), 1u);
  EXPECT_NEAR(of_a.cameras.at("hall"), 0.9, 0.05);
  ASSERT_EQ(of_b.cameras.size(), 2u);
  EXPECT_NEAR(of_b.cameras.at("hall"), 0.1, 0.02);
  EXPECT_NEAR(of_b.cameras.at("yard"), 1, 0.05);
  EXPECT_EQ(of_b.figures.at("flux_share"), of_b.cameras.at("yard"));
  grid.cuts.clear(), grid.cameras.clear();
  for (const Portal& portal : fit_portals(grid, {}).portals) EXPECT_TRUE(portal.cameras.empty());
}

// One camera's light passes the whole window, the other's only a part of it: neither's portal could
// stand for the other's.
TEST(PortalFit, LeavesEachCameraThePortalOfItsOwnLight) {
  const Opening whole = hole(0.4), part = hole(0.15);
  const FitResult fit = fit_portals(grid_of_cameras({{whole}, {part}}), {});
  ASSERT_EQ(fit.portals.size(), 2u);
  for (const Portal& portal : fit.portals) {
    ASSERT_EQ(portal.cameras.size(), 1u);
    const bool hall = portal.cameras.contains("hall");
    EXPECT_NEAR(portal.figures.at("area") / (hall ? whole : part).area(), 1, 0.1);
  }
}

TEST(PortalFit, FindsTwoWindows) {
  Opening a = hole(0.2), b = hole(0.2);
  b.middle.z += 0.8;
  b.middle.y += 0.1;
  a.share = 0.7;
  const LightGrid grid = grid_of(lines_through({a, b}, 4000));
  const FitResult fit = fit_portals(grid, {});
  ASSERT_EQ(fit.portals.size(), 2u);
  EXPECT_GT(score(fit.portals[0], a).coverage, 0.98);
  EXPECT_GT(score(fit.portals[1], b).coverage, 0.95);
  EXPECT_GT(score(fit.portals[1], b).tightness, 0.85);
  EXPECT_NEAR(fit.portals[0].figures.at("flux_share"), 0.7, 0.05);
  EXPECT_GT(fit.explained, 0.97);
  PortalFitOptions one;
  one.max_portals = 1;
  EXPECT_EQ(fit_portals(grid, one).portals.size(), 1u);
  PortalFitOptions strong;
  strong.threshold = 0.5;
  EXPECT_EQ(fit_portals(grid, strong).portals.size(), 1u);
}

// Lines of a second cut through an opening turned by 35 degrees that stands beside the first one
// by `aside` [m].
LightGrid grid_of_two_cuts(double aside) {
  const Opening first = hole(0.25);
  Opening second = first;
  const double turn = 35 / kDegrees;
  second.n = first.n * std::cos(turn) + normalize(first.u) * std::sin(turn);
  second.u = normalize(cross(first.v, second.n)) * length(first.u);
  second.middle += first.n * 0.1 + normalize(first.u) * aside;
  std::vector<LightLine> lines = lines_through({first}, 3000);
  for (const LightLine& line : lines_through({second}, 3000, {}, 2, 1)) lines.push_back(line);
  return grid_of(lines);
}

TEST(PortalFit, WhatTwoCutsFindInOnePlaceIsOnePortal) {
  EXPECT_EQ(fit_portals(grid_of_two_cuts(0), {}).portals.size(), 1u);
  EXPECT_EQ(fit_portals(grid_of_two_cuts(0.4), {}).portals.size(), 2u);
}

// Two large holes and 23 small ones: portals that carry next to nothing do not hide the others.
TEST(PortalFit, WhatCarriesLittleHidesNoOther) {
  std::vector<Opening> holes;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) {
      Opening o = hole();
      const bool large = i == 0 && j < 2;
      o.u = o.u * (large ? 0.25 : 0.14), o.v = o.v * (large ? 0.25 : 0.14);
      o.share = large ? 0.2 : 0.6 / 23;
      o.middle += normalize(o.u) * (0.5 * i) + normalize(o.v) * (0.5 * j);
      holes.push_back(o);
    }
  PortalFitOptions options;
  options.threshold = 0.05;
  const FitResult fit = fit_portals(grid_of(lines_through(holes, 8000)), options);
  ASSERT_EQ(fit.portals.size(), 2u);
  EXPECT_GT(score(fit.portals[0], holes[0]).coverage + score(fit.portals[0], holes[1]).coverage,
            0.95);
  ASSERT_FALSE(fit.refused.empty());
  EXPECT_NE(fit.refused.back().why.find(" of the light crosses "), std::string::npos)
      << fit.refused.back().why;
  EXPECT_TRUE(fit.refused.back().why.ends_with(", less than 5 %"));
}

// `n` panes, each `wide` along u, `step` apart; all in the plane of hole().
std::vector<Opening> row_of_panes(int n, double wide, double step) {
  std::vector<Opening> panes;
  for (int i = 0; i < n; ++i) {
    Opening o = hole(0.5, 0.01);
    o.u = normalize(o.u) * (0.5 * wide);
    o.middle += normalize(o.u) * (step * (i - 0.5 * (n - 1)));
    o.share = 1.0 / n;
    panes.push_back(o);
  }
  return panes;
}

// Panes and blinds are one window; twin: windows with a wall between them are not joined.
TEST(PortalFit, PanesAreOneWindow) {
  for (const auto& [n, wide, step, whole] : std::vector<std::tuple<int, double, double, double>>{
           {4, 0.3, 0.34, 1.32}, {30, 0.02, 0.04, 1.18}}) {
    const auto panes = row_of_panes(n, wide, step);
    const FitResult fit = fit_portals(grid_of(lines_through(panes, 4000)), {});
    ASSERT_EQ(fit.portals.size(), 1u);
    for (const size_t i : {size_t{0}, panes.size() / 2})
      EXPECT_GT(score(fit.portals[0], panes[i]).coverage, 0.97);
    EXPECT_NEAR(fit.portals[0].figures.at("area"), whole, 0.05 * whole);
    EXPECT_LT(score(fit.portals[0], panes[0]).angle, 3);
  }
  const FitResult apart = fit_portals(grid_of(lines_through(row_of_panes(4, 0.3, 0.5), 4000)), {});
  ASSERT_EQ(apart.portals.size(), 4u);
  for (const Portal& portal : apart.portals) EXPECT_NEAR(portal.figures.at("area"), 0.3, 0.03);
}

TEST(PortalFit, WindowsWithFewPerCentEachAreFound) {
  const auto windows = row_of_panes(6, 0.3, 1);
  Light light;
  light.strays = 0.6;
  light.reach = 3;
  const LightGrid grid = in_a_wall(grid_of(lines_through(windows, 5000, light)), windows);
  const FitResult fit = fit_portals(grid, {});
  // Outliers scattered over the box do not make a seventh.
  ASSERT_EQ(fit.portals.size(), 6u);
  for (const Portal& portal : fit.portals) {
    EXPECT_LT(portal.figures.at("flux_share"), 0.1);
    EXPECT_NEAR(portal.figures.at("area"), 0.3, 0.04);
  }
  // Twin: with a higher threshold none is found.
  PortalFitOptions more;
  more.threshold = 0.1;
  EXPECT_TRUE(fit_portals(grid, more).portals.empty());
}

// Unbounded lines: they scatter about a centre and about a direction.
std::vector<LightLine> lines_in_the_open(size_t n) {
  std::vector<LightLine> lines;
  for (uint64_t i = 0; i < n; ++i) {
    Rng rng(9, 1, i);
    const auto bell = [&] {
      double sum = -3;
      for (int k = 0; k < 6; ++k) sum += rng.uniform();
      return sum;
    };
    const double y = bell(), z = bell();
    const double a = 0.3 * bell(), b = 0.3 * bell();
    const Vec3d p{1, 2 + y, 3 + z}, w = normalize(Vec3d{1, a, b});
    lines.push_back({p - w * 2, p + w * 2});
  }
  return lines;
}

// Lines in all directions crowd at a place where they have no waist: the opening beside it is found
// all the same. Twin: of the crowd alone there is none.
TEST(PortalFit, ACrowdWithoutAWaistHidesNoOpening) {
  std::vector<LightLine> lines, crowd;
  for (uint64_t i = 0; i < 50; ++i) {
    Rng rng(11, 1, i);
    const double u = rng.uniform(), v = rng.uniform();
    const double z = 2 * u - 1, r = std::sqrt(1 - z * z), phi = 2 * std::numbers::pi * v;
    const Vec3d w{r * std::cos(phi), r * std::sin(phi), z},
        p = hole(0.5, 0.01).middle + Vec3d{1, 1, 1};
    crowd.push_back({p - w, p + w});
  }
  lines = lines_through({hole(0.5, 0.01)}, 400);
  lines.insert(lines.end(), crowd.begin(), crowd.end());
  const FitResult fit = fit_portals(grid_of(lines), {});
  ASSERT_EQ(fit.portals.size(), 1u);
  EXPECT_NEAR(fit.portals[0].figures.at("area"), hole(0.5, 0.01).area(), 0.1);
  EXPECT_TRUE(fit_portals(grid_of(crowd), {}).portals.empty());
}

TEST(PortalFit, RefusesAPlaneInTheOpen) {
  const FitResult fit = fit_portals(in_a_wall(grid_of(lines_in_the_open(4000)), {}), {});
  EXPECT_TRUE(fit.portals.empty());
  ASSERT_FALSE(fit.refused.empty());
  EXPECT_NE(fit.refused[0].why.find(" m2 lies across a room: "), std::string::npos)
      << fit.refused[0].why;
}

// Depths of a portal's corners before a pane of 2 cm in the hole's middle that faces along `face`
// [thicknesses of the pane]; it starts at 0 and ends at 1.
std::vector<double> depths_before_glass(const Vec3d& face, bool told) {
  const Opening deep = hole(0.25, 0.2);
  LightGrid grid = in_a_wall(grid_of(lines_through({deep}, 4000)), {deep});
  const Vec3d front = deep.middle - face * 0.01 + deep.u;
  if (told) grid.panes = {{front, front + face * 0.02}};
  const FitResult fit = fit_portals(grid, {});
  EXPECT_EQ(fit.portals.size(), 1u);
  EXPECT_GT(score(fit.portals[0], deep).coverage, 0.97);
  std::vector<double> depths;
  for (const Vec3d& corner : fit.portals[0].vertices)
    depths.push_back(dot(corner - front, deep.n) / 0.02 * dot(deep.n, face));
  return depths;
}

TEST(PortalFit, APortalStandsBeforeSolidGlass) {
  for (const double depth : depths_before_glass(hole().n, true)) EXPECT_GT(depth, 1);
  for (const double depth : depths_before_glass(-hole().n, true)) EXPECT_LT(depth, 0);
  // Twin: it would stand in it.
  const std::vector<double> untold = depths_before_glass(hole().n, false);
  EXPECT_LT(*std::min_element(untold.begin(), untold.end()), 1);
  EXPECT_GT(*std::max_element(untold.begin(), untold.end()), 0);
  // Glass in another wall, at right angles, moves nothing.
  LightGrid grid = in_a_wall(grid_of(lines_through({hole()}, 2000)), {hole()});
  const Vec3d middle = hole().middle, without = fit_portals(grid, {}).portals.at(0).vertices[0];
  grid.panes = {{middle - hole().u * 0.04, middle + hole().u * 0.04}};
  EXPECT_EQ(fit_portals(grid, {}).portals.at(0).vertices[0], without);
}

TEST(PortalFit, RefusesWithoutSupport) {
  LightGrid grid = grid_of(lines_through({hole()}, 2000));
  for (const LightLine& line : grid.lines) grid.probes.push_back({line, true});
  const FitResult good = fit_portals(grid, {});
  ASSERT_EQ(good.portals.size(), 1u);
  EXPECT_EQ(good.portals[0].figures.at("support"), 1);
  for (size_t i = 0; i < grid.probes.size(); ++i) grid.probes[i].joins = i % 10 == 0;
  const FitResult bad = fit_portals(grid, {});
  EXPECT_TRUE(bad.portals.empty());
  ASSERT_FALSE(bad.refused.empty());
  EXPECT_NE(bad.refused[0].why.find("lies within one side"), std::string::npos);
  EXPECT_TRUE(bad.refused[0].why.ends_with(", less than 50 %"));
  EXPECT_TRUE(fit_portals(LightGrid{}, {}).portals.empty());  // and without lines
}

// Score itself must detect faults: a portal turned, shifted or facing the other way.
TEST(PortalScore, SeesWhatIsWrong) {
  const Opening o = hole();
  Portal p;
  const auto corner = [&](double u, double v) { return o.middle + o.u * u + o.v * v; };
  p.vertices = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Score good = score(p, o);
  EXPECT_EQ(good.coverage, 1);
  EXPECT_NEAR(good.tightness, 1, 1e-12);
  EXPECT_NEAR(good.angle, 0, 1e-6);
  Portal shifted = p;
  for (Vec3d& v : shifted.vertices) v.y += 0.15;
  EXPECT_LT(score(shifted, o).coverage, 0.9);
  Portal backwards = p;
  for (auto& t : backwards.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(score(backwards, o).coverage, 0);
  EXPECT_NEAR(score(backwards, o).angle, 180, 1e-6);
  Portal large = p;
  for (Vec3d& v : large.vertices) v = o.middle + (v - o.middle) * 1.5;
  EXPECT_LT(score(large, o).tightness, 0.5);
}

}  // namespace tdpt::portalfit_test
