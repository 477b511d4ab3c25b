#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/ffgraph/rounds.h"
#include "tools/ffgraph/walks.h"

namespace tdpt::walks_test {

// The sky as patches of the network: no light leaks into a closed box, a window connects it to the
// sky, and a sun outshines no window.

// A box from -0.5 to 0.5 with a square hole of side `hole` in one wall; 0: none.
Scene box(float hole) {
  Scene s;
  s.materials.resize(1);
  s.hash = "box";
  const auto quad = [&s](const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    const auto first = static_cast<uint32_t>(s.positions.size());
    s.positions.insert(s.positions.end(), {a, b, c, d});
    s.triangles.push_back({{first, first + 1, first + 2}, 0});
    s.triangles.push_back({{first, first + 2, first + 3}, 0});
  };
  const float h = 0.5f, o = 0.5f * hole;
  quad({-h, -h, -h}, {h, -h, -h}, {h, -h, h}, {-h, -h, h});
  quad({-h, h, -h}, {h, h, -h}, {h, h, h}, {-h, h, h});
  quad({-h, -h, -h}, {-h, h, -h}, {-h, h, h}, {-h, -h, h});
  quad({-h, -h, -h}, {h, -h, -h}, {h, h, -h}, {-h, h, -h});
  quad({-h, -h, h}, {h, -h, h}, {h, h, h}, {-h, h, h});
  // x = 0.5, around the hole.
  quad({h, -h, -h}, {h, h, -h}, {h, h, -o}, {h, -h, -o});
  quad({h, -h, o}, {h, h, o}, {h, h, h}, {h, -h, h});
  quad({h, -h, -o}, {h, -o, -o}, {h, -o, o}, {h, -h, o});
  quad({h, o, -o}, {h, h, -o}, {h, h, o}, {h, o, o});
  s.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(1.0f)}}, 0.0);
  return s;
}

const Camera kCamera{"", {-0.3, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 1.2, 1};

LightFlow flow_of(const Scene& scene, const CutFile* cut = nullptr) {
  GraphSettings settings;
  settings.walks.walks = 10000;
  settings.rays = 100000;
  settings.rounds = 0;
  GraphReport report;
  Phases phases;
  return build_graph(scene, {kCamera}, settings, cut, report, phases);
}

// A box with a window.
const Scene kRoom = box(0.3f);
const LightFlow& flow_of_room() {
  static const LightFlow flow = flow_of(kRoom);
  return flow;
}

bool inside(const Patch& p) {
  // Walls face inwards.
  return !p.is_sky() && dot(p.normal, p.centre) < 0;
}

// Etendue between the sky and the inside of the box / that of the whole wall.
double through_hole(const LightFlow& f) {
  double across = 0, wall = 0;
  for (const Patch& p : f.file.patches)
    if (inside(p) && p.normal.x > 0.9) wall += p.samples;
  for (const Etendue::Pair& p : f.etendue.pairs)
    if ((f.patches.is_sky(p.i) && inside(f.file.patches[p.j])) ||
        (f.patches.is_sky(p.j) && inside(f.file.patches[p.i])))
      across += 0.5 * p.count;
  return across / wall;
}

// By reciprocity, the etendue between a convex room and the sky through a hole is the hole's area.
TEST(sky_patches, see_a_room_by_the_area_of_its_window) {
  const Scene closed = box(0), wider = box(0.33f);
  EXPECT_EQ(through_hole(flow_of(closed)), 0);
  EXPECT_NEAR(through_hole(flow_of_room()), 0.09, 0.004);
  EXPECT_GT(std::abs(through_hole(flow_of(wider)) - 0.09), 0.01);  // twin
}

TEST(sky_patches, have_the_samples_that_they_exchange_and_begin_walks_that_land) {
  const LightFlow& f = flow_of_room();
  uint32_t bins = 0;
  double begun = 0;
  for (uint32_t i = 0; i < f.patches.size(); ++i) {
    if (!f.patches.is_sky(i)) continue;
    EXPECT_EQ(f.file.patches[i].sky, static_cast<int32_t>(bins++));
    EXPECT_TRUE(f.file.patches[i].faces.empty());
    EXPECT_EQ(f.file.walks[i].light, 0);
    EXPECT_EQ(f.file.walks[i].camera[0], 0);
    double exchanged = 0;
    for (const Etendue::Pair& p : f.etendue.pairs)
      if (p.i == i || p.j == i) exchanged += 0.5 * p.count;
    EXPECT_NEAR(f.file.patches[i].samples, exchanged, 1e-9 * exchanged);
    begun += f.file.walks[i].begun;
  }
  EXPECT_EQ(bins, kSkyBins);
  EXPECT_GT(begun, 2500);
  EXPECT_LE(begun, 10000);
}

TEST(sky_patches, keep_their_places_when_the_network_is_refined) {
  const LightFlow& f = flow_of_room();
  CutFile cut;
  cut.grid = f.patches.grid();
  cut.patches = f.file.patches;
  cut.cuts.resize(1);
  for (const Patch& p : cut.patches) cut.sides.push_back(inside(p));
  check_patches("a.cut", kRoom, cut);
  const LightFlow finer = flow_of(kRoom, &cut);
  uint32_t bins = 0;
  for (uint32_t i = 0; i < finer.patches.size(); ++i) bins += finer.patches.is_sky(i);
  EXPECT_EQ(bins, kSkyBins);
}

TEST(sky_grades, end_at_one_so_that_a_sun_hides_nothing) {
  std::vector<double> light(kSkyBins);
  for (uint32_t k = 0; k < kSkyBins; ++k) light[k] = sky_bin_solid_angle(k);
  light[3] *= 1e6;
  light[5] *= 0.1;
  light[6] = 0;
  const std::vector<double> grade = sky_grades(light);
  EXPECT_EQ(grade[3], 1);
  EXPECT_EQ(grade[4], 1);
  EXPECT_NEAR(grade[5], 0.2, 1e-9);
  EXPECT_EQ(grade[6], 0);
  for (double& l : light) l *= 1000;
  EXPECT_NEAR(sky_grades(light)[5], 0.2, 1e-9);  // power has no effect
}

TEST(sky_lines, come_from_outside_and_half_of_them_to_the_aim) {
  Scene scene = box(0);
  PunctualLight sun;
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3d{1, -2, 0.5});
  sun.intensity = Rgb(1e6f);
  scene.lights = {sun};
  Extent aim;
  aim.add({0.2, 0.2, 0.2});
  aim.add({0.3, 0.3, 0.3});
  const SkyLines lines(scene, aim, aim);
  constexpr int kLines = 20000;
  int aimed = 0, of_sun = 0;
  Rng rng(1, 0, 0);
  for (int i = 0; i < kLines; ++i) {
    const SkyLines::Line line = lines.draw(rng);
    EXPECT_GT(length(line.origin), 0.86);
    EXPECT_NEAR(length(line.direction), 1, 1e-9);
    EXPECT_EQ(line.bin, sky_bin(-line.direction));
    const Vec3d off = line.origin - Vec3d(0.25);
    aimed += length(off - line.direction * dot(off, line.direction)) < 0.11;
    of_sun += dot(line.direction, sun.direction) > 1 - 1e-9;
  }
  EXPECT_NEAR(aimed, 0.75 * kLines, 0.03 * kLines);
  // Half by light, almost all from the sun; the other half gives it the share of one bin.
  EXPECT_NEAR(of_sun, 0.5 * kLines, 0.03 * kLines);
}

}  // namespace tdpt::walks_test
