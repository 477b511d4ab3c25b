// Portals are turned according to a small picture's light, in rooms where light is known to pass
// them one way, both ways, or not at all.
#include "tools/tdpt-render/plan/exploration.h"

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::portal_ways_test {

constexpr auto kAsDrawn = PortalWay::as_drawn, kFront = PortalWay::front, kBack = PortalWay::back,
               kBoth = PortalWay::both, kLeftOut = PortalWay::left_out;

Portal turned_round(Portal portal) {
  for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  return portal;
}
Portal for_both_ways(Portal portal) {
  portal.both_ways = true;
  return portal;
}

Scene scene_of(const std::string& name) {
  return read_gltf(TDPT_TESTDATA "/scenes/" + name);
}
std::vector<PortalWay> ways_in(const Scene& scene, const std::vector<Portal>& portals,
                               uint64_t seed = 1) {
  Vista vista(scene, scene.camera(""), 320, 240, portals);
  const std::vector<PortalWay> ways = explore(vista, scene.camera(""), portals, 6, seed).ways;
  EXPECT_EQ(ways.size(), portals.size());
  EXPECT_EQ(vista.view.film.width(), 320);
  EXPECT_EQ(vista.openings.portals.size(), PortalSet(portals, scene.frame).size());
  return ways;
}
using Ways = std::vector<PortalWay>;

/// A portal in a wall between rooms, with light going to -x; y and z extents.
Portal in_the_wall(double x, double y0, double y1, double z0, double z1) {
  return rectangle({x, y0, z0}, {0, 0, z1 - z0}, {0, y1 - y0, 0});
}
/// The gap beside the leaf of door-ajar, and the small one above it.
std::vector<Portal> round_the_leaf() {
  return {rectangle({1.89, 0, 0.372}, {0.11, 0, 0.028}, {0, 1.82, 0}),
          {"above", {{1.89, 1.815, 0.372}, {2, 1.82, 0.4}, {2, 1.82, -0.395}}, {{0, 1, 2}}, {}}};
}

TEST(way_of, asks_for_light_that_is_clear) {
  struct Passed {
    double all, sure;
  };
  const Passed much{100, 99}, tenth{10, 9}, little{2, 1.9}, none{0, 0}, half{60, 59}, few{100, 0},
      one_sample{100, 0.1};
  struct Row {
    bool both;
    Passed with, against;
    double total;
    bool wide;
    PortalWay way;
  };
  for (const Row& r : {Row{false, much, none, 200, false, kAsDrawn},
                       {false, much, tenth, 200, false, kAsDrawn},
                       {false, none, much, 200, false, kBack},
                       {false, tenth, much, 200, false, kBack},
                       {false, half, much, 200, false, kBoth},
                       {true, much, none, 200, false, kFront},
                       {true, much, tenth, 200, false, kFront},
                       {true, tenth, much, 200, false, kBack},
                       {true, much, half, 200, false, kAsDrawn},
                       {false, half, much, 200, true, kAsDrawn},
                       {false, none, much, 200, true, kBack},
                       {true, much, half, 200, true, kFront},
                       {true, half, much, 200, true, kBack},
                       {true, none, few, 200, false, kAsDrawn},
                       {false, little, one_sample, 200, false, kAsDrawn},
                       {false, none, much, 1e6, false, kAsDrawn},
                       {true, none, none, 0, false, kAsDrawn}})
    EXPECT_EQ(
        way_of(r.both, {r.with.all, r.against.all}, {r.with.sure, r.against.sure}, r.total, r.wide),
        r.way)
        << r.both << " " << r.with.all << " " << r.against.all << " " << r.wide;
}

TEST(portal_ways, turns_the_small_portal_of_a_door_ajar) {
  const Scene scene = scene_of("door-ajar.glb");
  const std::vector<Portal> right = round_the_leaf();
  EXPECT_EQ(ways_in(scene, right), (Ways{kAsDrawn, kAsDrawn}));
  const auto [gap, above] = std::pair(right[0], right[1]);
  EXPECT_EQ(ways_in(scene, {gap, turned_round(above)}), (Ways{kAsDrawn, kBack}));
  EXPECT_EQ(ways_in(scene, {turned_round(gap), above}, 2), (Ways{kBack, kAsDrawn}));
  EXPECT_EQ(ways_in(scene, {for_both_ways(gap), for_both_ways(turned_round(above))}),
            (Ways{kFront, kBack}));
}

TEST(portal_ways, are_found_for_holes_and_windows) {
  const std::vector<std::pair<const char*, Portal>> openings{
      {"small-hole.glb", in_the_wall(2.05, 0.95, 1.05, -0.05, 0.05)},
      {"two-rooms.glb", portal_in_the_hole()},
      {"window.glb", in_the_wall(2.05, 0.2, 1.8, -0.8, 0.8)}};
  for (const auto& [name, portal] : openings) {
    const Scene scene = scene_of(name);
    EXPECT_EQ(ways_in(scene, {portal}), Ways{kAsDrawn}) << name;
    EXPECT_EQ(ways_in(scene, {turned_round(portal)}), Ways{kBack}) << name;
    EXPECT_EQ(ways_in(scene, {for_both_ways(portal)}), Ways{kFront}) << name;
    EXPECT_EQ(ways_in(scene, {for_both_ways(turned_round(portal))}), Ways{kBack}) << name;
  }
}

TEST(portal_ways, finds_a_hole_beside_far_larger_portals) {
  const Scene scene = scene_of("small-hole.glb");
  const Portal across = in_the_wall(1.2, 0.02, 1.98, -0.98, 0.98);
  const Ways ways =
      ways_in(scene, {across, turned_round(in_the_wall(2.05, 0.95, 1.05, -0.05, 0.05)),
                      in_the_wall(1.6, 0.02, 1.98, -0.98, 0.98)});
  EXPECT_EQ(ways[1], kBack);
}

TEST(portal_ways, leaves_out_what_no_light_passes) {
  const Scene scene = scene_of("two-rooms.glb");
  const Portal in_the_stone = in_the_wall(2.05, 1.5, 1.9, -0.8, 0.8);
  const Portal away = in_the_wall(9, 0, 2, -1, 1);
  EXPECT_EQ(ways_in(scene, {in_the_stone, for_both_ways(in_the_stone), away}),
            (Ways{kLeftOut, kLeftOut, kLeftOut}));
  EXPECT_EQ(ways_in(scene, {in_the_stone, portal_in_the_hole()}), (Ways{kLeftOut, kAsDrawn}));
  // Light passes behind the camera, where next to none of it is seen.
  const Portal corner = rectangle({0.05, 0.02, -0.97}, {0, 0, 0.1}, {0, 0.1, 0});
  EXPECT_EQ(ways_in(scene, {corner}), Ways{kLeftOut});
  // Where next to no light was found nothing is decided about portals.
  Scene dark = scene;
  for (Material& m : dark.materials) m.emission = {};
  EXPECT_EQ(ways_in(dark, {turned_round(portal_in_the_hole())}), Ways{kAsDrawn});
  EXPECT_EQ(ways_in(scene, {}), Ways{});
}

// A portal across the camera's room: light from the window passes on, and comes back from the
// walls. The whole cross-section is wide, where both ways cost more than they gain; a strip of it
// is not.
TEST(portal_ways, lets_light_pass_both_ways_where_it_does) {
  const Scene scene = scene_of("window.glb");
  const Portal section = in_the_wall(0.8, 0.02, 1.98, -0.98, 0.98);
  EXPECT_EQ(ways_in(scene, {section, turned_round(section)}), (Ways{kAsDrawn, kAsDrawn}));
  EXPECT_NE(ways_in(scene, {for_both_ways(section)}), Ways{kAsDrawn});
  const Portal slip = in_the_wall(0.8, 0.9, 1.1, -0.2, 0.2);
  EXPECT_EQ(ways_in(scene, {slip}), Ways{kBoth});
  EXPECT_EQ(ways_in(scene, {turned_round(slip)}), Ways{kBoth});
  EXPECT_EQ(ways_in(scene, {for_both_ways(slip)}), Ways{kAsDrawn});
}

TEST(portal_ways, portals_in_a_row_are_judged_one_by_one) {
  const Scene scene = scene_of("three-rooms.glb");
  const Portal first = in_the_wall(4.15, 0.75, 1.25, -0.25, 0.25);
  const Portal second = in_the_wall(2.05, 0.75, 1.25, -0.25, 0.25);
  EXPECT_EQ(ways_in(scene, {first, turned_round(second)}), (Ways{kAsDrawn, kBack}));
}

// Lamps without surface: one in the far room, and the sun, which shines straight through the hole
// from where nothing reflects it.
TEST(portal_ways, knows_light_of_lamps_without_surface) {
  Scene scene = scene_of("two-rooms.glb");
  for (Material& m : scene.materials) m.emission = {};
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({3, 1, 0.3});
  lamp.intensity = Rgb(1.0f);
  Scene lit = scene;
  lit.lights.push_back(lamp);
  EXPECT_EQ(ways_in(lit, {portal_in_the_hole()}), Ways{kAsDrawn});
  EXPECT_EQ(ways_in(lit, {turned_round(portal_in_the_hole())}), Ways{kBack});

  std::erase_if(scene.triangles, [&](const Triangle& t) {
    double x = 0;
    for (const uint32_t v : t.vertex)
      x = std::max(x, scene.frame.to_metres(Vec3d(scene.positions[v])).x);
    return x > 2.2;
  });
  lamp.kind = PunctualLight::Kind::directional;
  lamp.direction = normalize(Vec3d(-1, -0.3, 0.1));
  scene.lights.push_back(lamp);
  EXPECT_EQ(ways_in(scene, {portal_in_the_hole()}), Ways{kAsDrawn});
  EXPECT_EQ(ways_in(scene, {turned_round(portal_in_the_hole())}), Ways{kBack});
}

TEST(apply_ways, turns_portals_and_lets_them_work_both_ways) {
  const Portal hole = portal_in_the_hole();
  std::vector<Portal> portals{hole, hole, for_both_ways(hole), for_both_ways(hole), hole};
  apply_ways({kAsDrawn, kBack, kFront, kBack, kBoth}, portals);
  EXPECT_EQ(portals[0].triangles, hole.triangles);
  EXPECT_EQ(portals[1].triangles, turned_round(hole).triangles);
  EXPECT_EQ(portals[2].triangles, hole.triangles);
  EXPECT_FALSE(portals[2].both_ways);
  EXPECT_EQ(portals[3].triangles, turned_round(hole).triangles);
  EXPECT_FALSE(portals[3].both_ways);
  EXPECT_TRUE(portals[4].both_ways);
  apply_ways({kAsDrawn, kLeftOut}, portals);
  EXPECT_TRUE(portals[1].triangles.empty());
  EXPECT_NEAR(portals[1].figures.at("area"), 0.0625, 1e-12);
}

double conductance_in(const char* scene_name, const Portal& portal) {
  return probed_conductance(World(scene_of(scene_name), false), portal);
}

bool near(double measured, double expected) {
  return measured > 0.75 * expected && measured < 1.33 * expected;
}

// The room's surface is 24 m2, less the opening.
TEST(portal_probe, measures_the_opening_against_the_room) {
  const double window = 2.56 / 24;
  EXPECT_TRUE(near(conductance_in("window.glb", in_the_wall(2.05, 0.2, 1.8, -0.8, 0.8)), window));
  // Twin: a portal over a quarter of the window has another conductance.
  EXPECT_FALSE(near(conductance_in("window.glb", in_the_wall(2.05, 0.2, 1, -0.8, 0)), window));
  EXPECT_LT(conductance_in("two-rooms.glb", portal_in_the_hole()), 0.01);
}

}  // namespace tdpt::portal_ways_test
