#include "libcommon/math/series_cut.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::series_cut_test {

constexpr int kPatches = 20;  // patches per room

// Rooms in a row with kPatches patches of 50 samples each, all mutually visible; `door[r]` connects
// the patches of room r to those of room r + 1. The camera is in room 0, the lamp in the last; the
// terminals reach other rooms as strongly as the doors allow. Patches of a room exchange `each` of
// a patch's capacity of 50000.
PatchNetwork rooms_in_row(const std::vector<int64_t>& door, int64_t each = 25000 / kPatches) {
  const auto rooms = static_cast<uint32_t>(door.size() + 1);
  PatchNetwork p;
  p.scale = 1000;
  p.network = {2 + rooms * kPatches, 0, 1, {}};
  p.samples.assign(p.network.nodes, 50);
  p.samples[0] = p.samples[1] = 0;
  const auto node = [](uint32_t room, uint32_t i) { return 2 + room * kPatches + i; };
  for (uint32_t r = 0; r < rooms; ++r)
    for (uint32_t i = 0; i < kPatches; ++i) {
      for (uint32_t j = 0; j < kPatches; ++j)
        if (i != j) p.network.arcs.push_back({node(r, i), node(r, j), each});
      if (r == 0) p.network.arcs.push_back({node(r, i), 1, 50000});
      if (r + 1 == rooms) p.network.arcs.push_back({0, node(r, i), 50000});
    }
  for (uint32_t r = 0; r + 1 < rooms; ++r) {
    for (uint32_t i = 0; i < kPatches; ++i) {
      p.network.arcs.push_back({node(r, i), node(r + 1, i), door[r] / kPatches});
      p.network.arcs.push_back({node(r + 1, i), node(r, i), door[r] / kPatches});
    }
  }
  return p;
}

// Region of each room if all its patches share one; 99 otherwise.
std::vector<uint32_t> regions(const PatchNetwork& p, const SeriesCut& cut) {
  std::vector<uint32_t> of_room;
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    if ((v - 2) % kPatches == 0) of_room.push_back(cut.region[v]);
    if (cut.region[v] != of_room.back()) of_room.back() = 99;
  }
  return of_room;
}

// Two rooms, of which the sky replaces the lamp's, wide open to the other or not.
struct UnderASky {
  PatchNetwork network;
  std::vector<uint8_t> source_side;

  explicit UnderASky(int64_t window, bool sky = true) : network(rooms_in_row({window})) {
    const uint32_t n = network.network.nodes;
    network.begun.assign(n, 0), network.lit.assign(n, 0), network.viewed.assign(n, 0);
    if (sky) network.sky.assign(n, 0);
    source_side.assign(n, 0);
    source_side[0] = 1;
    for (uint32_t v = 2; v < n; ++v) {
      const bool outside = v >= 2 + kPatches;
      source_side[v] = outside;
      if (outside && sky) network.sky[v] = 1;
      (outside ? network.begun : network.viewed)[v] = 1000;
    }
  }
};

// A lamp that shines straight through its window needs no portal, but a sky does.
TEST(cut_facts, light_straight_from_the_sky_refuses_no_window) {
  const UnderASky sky(60000), lamp(60000, false);
  const CutFacts of_sky = facts_of(sky.network, sky.source_side);
  EXPECT_EQ(of_sky.straight, 0);
  EXPECT_FALSE(of_sky.back.has_value());
  EXPECT_EQ(of_sky.viewed[1], 1);
  EXPECT_FALSE(of_sky.seen.has_value());
  EXPECT_FALSE(lamp_in_its_opening(of_sky, {}));
  EXPECT_EQ(why_refused(of_sky, {}), "");
  const CutFacts of_lamp = facts_of(lamp.network, lamp.source_side);  // twin
  EXPECT_EQ(of_lamp.straight, 1);
  EXPECT_GT(of_lamp.seen.value_or(0), 0.05);
}

TEST(cut_facts, a_cut_that_parts_the_sky_is_none) {
  UnderASky parted(300);
  EXPECT_EQ(facts_of(parted.network, parted.source_side).sky_beyond, 0);
  for (uint32_t v = 2 + kPatches; v < 2 + kPatches + kPatches / 4; ++v) parted.source_side[v] = 0;
  const CutFacts facts = facts_of(parted.network, parted.source_side);
  EXPECT_NEAR(facts.sky_beyond, 0.25, 1e-9);
  EXPECT_EQ(why_refused(facts, {}),
            "25 % of the sky lies on the camera's side of the cut, which parts the open");
}

TEST(cut_facts, a_room_whose_wall_is_missing_stands_open_to_the_sky) {
  const UnderASky open(200000), lamp(200000, false);
  const CutFacts facts = facts_of(open.network, open.source_side);
  EXPECT_EQ(facts.sky_across, 1);
  EXPECT_EQ(why_refused(facts, {}).find("the room stands open to the sky: "), 0u)
      << why_refused(facts, {});
  EXPECT_NE(why_refused(facts, {}).find("of its light crosses the opening, more than 0.12, so that "
                                        "the sky is found without a portal"),
            std::string::npos)
      << why_refused(facts, {});
  // Twin: another room instead of the sky.
  CutFacts behind = facts;
  behind.sky_across = 0;
  EXPECT_NE(why_refused(behind, {}).find("the opening is wide"), std::string::npos);
  EXPECT_EQ(facts_of(lamp.network, lamp.source_side).sky_across, 0);
}

TEST(series_cut, finds_every_door_of_a_row_in_the_lights_order) {
  for (const std::vector<int64_t>& doors :
       {std::vector<int64_t>{400}, {400, 300}, {300, 400}, {350, 300, 400, 200}}) {
    const PatchNetwork p = rooms_in_row(doors);
    const SeriesCut cut = series_cut(p, 8, {});
    EXPECT_TRUE(cut.bottleneck) << cut.reason;
    EXPECT_EQ(cut.cuts.size(), doors.size());
    EXPECT_EQ(cut.drops, doors.size());
    EXPECT_EQ(cut.passed + cut.closets, 0u);
    std::vector<uint32_t> expected;
    for (size_t r = 0; r <= doors.size(); ++r)
      expected.push_back(static_cast<uint32_t>(doors.size() - r));
    EXPECT_EQ(regions(p, cut), expected);
    for (size_t c = 0; c < cut.cuts.size(); ++c) {
      EXPECT_GT(cut.cuts[c].facts.conductance, 0);
      EXPECT_LE(cut.cuts[c].facts.conductance, 0.12);
    }
  }
}

TEST(series_cut, takes_the_narrowest_when_it_may_take_one_only) {
  const PatchNetwork p = rooms_in_row({400, 300});
  const SeriesCut cut = series_cut(p, 1, {});
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(cut.cuts[0].flow, 300);
  EXPECT_EQ(regions(p, cut), (std::vector<uint32_t>{1, 1, 0}));
}

TEST(series_cut, does_not_cut_what_is_one_room) {
  // A door as wide as the room is no door, whatever lies behind it.
  const PatchNetwork p = rooms_in_row({400, 200000});
  const SeriesCut cut = series_cut(p, 8, {});
  EXPECT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(regions(p, cut), (std::vector<uint32_t>{1, 0, 0}));
  const PatchNetwork open = rooms_in_row({200000});
  const SeriesCut none = series_cut(open, 8, {});
  EXPECT_FALSE(none.bottleneck);
  EXPECT_EQ(none.cuts.size(), 1u);
  EXPECT_NE(none.reason, "");
}

// A closet off the light's way has a door, too, but no light passes it on its way to the camera.
TEST(series_cut, leaves_a_closet_beside_the_lights_way_alone) {
  PatchNetwork p = rooms_in_row({400, 300});
  // Room 2, the lamp's, loses its arcs to the lamp; room 1 becomes the lamp's: 2 is a closet.
  for (FlowArc& a : p.network.arcs)
    if (a.from == 0) a.to -= kPatches;
  const SeriesCut cut = series_cut(p, 8, {});
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(cut.drops, 2u);
  EXPECT_EQ(cut.closets, 1u);
  EXPECT_EQ(regions(p, cut)[0], 1u);
  EXPECT_EQ(regions(p, cut)[1], 0u);
}

TEST(series_cut, a_candidate_that_fails_hides_none_that_holds) {
  // The second door is too wide, but is examined, since sweep cuts are worse than minimum cuts.
  const PatchNetwork p = rooms_in_row({20000, 70000});
  const SeriesCut cut = series_cut(p, 8, {});
  EXPECT_TRUE(cut.bottleneck);
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(regions(p, cut), (std::vector<uint32_t>{1, 0, 0}));
  ASSERT_EQ(cut.refused.size(), 1u);
  EXPECT_NE(cut.refused[0].why.find("the opening is wide"), std::string::npos);
  EXPECT_GT(cut.refused[0].facts.conductance, 0.12);
  // With a larger limit it is found.
  CutLimits wide;
  wide.largest_conductance = 0.3;
  EXPECT_EQ(series_cut(p, 8, wide).cuts.size(), 2u);
}

// In each room three patches belong to the other by their terminals, as where the camera sees part
// of the lamp's room through the door: in the order of the potential they lie in between.
PatchNetwork rooms_seen_from_each_other() {
  PatchNetwork p = rooms_in_row({400}, 50000 / kPatches);
  for (FlowArc& a : p.network.arcs) {
    if (a.to == 1 && a.from < 2 + 3) a = {0, a.from, a.capacity};
    if (a.from == 0 && a.to >= 2 + kPatches && a.to < 2 + kPatches + 3) a = {a.to, 1, a.capacity};
  }
  return p;
}

TEST(series_cut, finds_an_opening_whose_sweep_cuts_are_all_too_wide) {
  const PatchNetwork p = rooms_seen_from_each_other();
  const SeriesCut cut = series_cut(p, 8, {});
  ASSERT_TRUE(cut.bottleneck) << cut.reason;
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(regions(p, cut), (std::vector<uint32_t>{1, 0}));
  EXPECT_NEAR(cut.cuts[0].facts.conductance, 400 / (20 * 19 * 2500 + 400.0), 1e-9);
  // Twin: the minimum cut of the unmodified network follows the terminals.
  const MaxFlow whole = max_flow(p.network);
  EXPECT_GT(facts_of(p, whole.source_side).conductance, 0.12);
}

// Walks of the lamp room's patches: `begun` and `lit` per patch, and those of the camera's room.
PatchNetwork lamp_before_a_door(double begun, double lit, double begun_beyond, double lit_beyond) {
  PatchNetwork p = rooms_in_row({130000});
  p.begun.assign(p.network.nodes, 0);
  p.lit = p.viewed = p.begun;
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    const bool beyond = v < 2 + kPatches;
    p.begun[v] = beyond ? begun_beyond : begun;
    p.lit[v] = beyond ? lit_beyond : lit;
    p.viewed[v] = beyond ? 10 : 1;
  }
  return p;
}

std::string why(const PatchNetwork& p) {
  CutLimits limits;
  limits.largest_conductance = 0.3;
  return series_cut(p, 8, limits).reason.substr(0, 38);
}

TEST(series_cut, says_what_the_walks_tell_of_the_opening) {
  // 0.13 of each patch's rays pass the door: 130000 / 20 / 50000.
  EXPECT_EQ(why(lamp_before_a_door(1, 10, 0, 1)), "");
  EXPECT_EQ(why(lamp_before_a_door(5, 10, 0, 1)), "the lamp stands in its own opening: 33");
  EXPECT_EQ(why(lamp_before_a_door(1, 10, 0, 10)), "as much light comes back across the cu");
  EXPECT_EQ(why(lamp_before_a_door(1, 10, 400, 1)), "as much light comes back across the cu");
  PatchNetwork seen = lamp_before_a_door(1, 10, 0, 1);
  std::swap(seen.viewed.front(), seen.viewed.back());
  for (double& w : seen.viewed) w = 5;
  EXPECT_EQ(why(seen), "the camera sees past the cut: its walk");
  const CutFacts facts = facts_of(seen, max_flow(seen.network).source_side);
  EXPECT_NEAR(*facts.straight, 1.0 / 11, 1e-9);
  EXPECT_NEAR(*facts.seen, 0.13, 1e-9);
  EXPECT_NEAR(*facts.back, 1.0 / 11, 1e-9);
  EXPECT_NEAR(*facts.across, 1, 1e-9);
}

// One camera walk that came through a keyhole and returned says nothing about the cut.
TEST(series_cut, walks_too_few_to_tell_refuse_no_cut) {
  const auto of_walks = [](double each) {
    PatchNetwork p = lamp_before_a_door(each, 10 * each, 0, 10 * each);
    for (double& w : p.viewed) w = each;
    return p;
  };
  EXPECT_EQ(why(of_walks(0.01)), "");
  const PatchNetwork few = of_walks(0.01);
  EXPECT_FALSE(facts_of(few, max_flow(few.network).source_side).back.has_value());
  EXPECT_FALSE(facts_of(few, max_flow(few.network).source_side).camera_back.has_value());
  EXPECT_NE(why(of_walks(10)), "");  // twin: with many walks the same shares do refuse it
}

TEST(cut_facts, a_niche_or_an_opening_may_be_the_lamps_own_but_no_open_room) {
  const auto own = [](double conductance, double light_side, double straight, double seen) {
    CutFacts f;
    f.area = f.volume = {light_side, 1 - light_side};
    f.conductance = conductance;
    f.straight = straight;
    f.seen = seen;
    return lamp_in_its_opening(f, {});
  };
  EXPECT_TRUE(own(0.1, 0.5, 0.3, 0.2));
  EXPECT_FALSE(own(0.1, 0.5, 0.3, 0.05));   // light sampling rarely finds the opening
  EXPECT_FALSE(own(0.1, 0.5, 0.1, 0.2));    // most light is scattered first
  EXPECT_FALSE(own(0.04, 0.5, 0.3, 0.2));   // a narrow door with the lamp near it
  EXPECT_FALSE(own(0.3, 0.5, 0.3, 0.2));    // half of an open room
  EXPECT_TRUE(own(0.3, 0.02, 0.3, 0.2));    // a window's niche
  EXPECT_FALSE(own(0.3, 0.02, 0.9, 0.95));  // a lamp in an open room
}

TEST(series_cut, tells_rooms_apart_that_light_and_camera_both_reach) {
  // A wide arch: the arcs of all terminals are saturated.
  PatchNetwork p = rooms_in_row({40000}, 50000 / kPatches);
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    const bool beyond = v < 2 + kPatches;
    p.network.arcs.push_back(beyond ? FlowArc{0, v, 50000} : FlowArc{v, 1, 50000});
  }
  EXPECT_FALSE(series_cut(p, 8, {}).bottleneck);
  p.begun.assign(p.network.nodes, 0);
  p.lit = p.viewed = p.begun;
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    const bool beyond = v < 2 + kPatches;
    p.lit[v] = beyond ? 700 : 1000;
    p.viewed[v] = beyond ? 1000 : 700;
  }
  const SeriesCut cut = series_cut(p, 8, {});
  ASSERT_TRUE(cut.bottleneck) << cut.reason;
  EXPECT_EQ(regions(p, cut), (std::vector<uint32_t>{1, 0}));
}

TEST(series_cut, a_wide_dark_ground_leaves_a_room_its_share) {
  // A patch with a hundred times the surface of both rooms that exchanges almost nothing.
  PatchNetwork p = rooms_in_row({400});
  const uint32_t ground = p.network.nodes++;
  p.samples.push_back(200000);
  p.network.arcs.push_back({ground, 2, 100});
  p.network.arcs.push_back({2, ground, 100});
  const SeriesCut cut = series_cut(p, 8, {});
  EXPECT_TRUE(cut.bottleneck) << cut.reason;
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_LT(std::min(cut.cuts[0].facts.area[0], cut.cuts[0].facts.area[1]), 0.03);
}

TEST(series_cut, a_terminal_that_reaches_nothing_is_told) {
  PatchNetwork dark = rooms_in_row({400}), blind = dark;
  std::erase_if(dark.network.arcs, [](const FlowArc& a) { return a.from == 0; });
  std::erase_if(blind.network.arcs, [](const FlowArc& a) { return a.to == 1; });
  EXPECT_EQ(series_cut(dark, 8, {}).reason, "no light reaches a surface");
  EXPECT_EQ(series_cut(blind, 8, {}).reason, "the camera sees no surface");
}

}  // namespace tdpt::series_cut_test
