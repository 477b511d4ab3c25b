#include "libcommon/flow/series_cut.h"

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

// A room that is a hundredth of the surface beside a landscape counts by the light that it
// scatters.
TEST(cut_facts, a_side_counts_by_what_it_weighs) {
  PatchNetwork p = rooms_in_row({300});
  for (uint32_t v = 2; v < 2 + kPatches; ++v) p.samples[v] = 1;
  std::erase_if(p.network.arcs, [](const FlowArc& a) {
    return a.from >= 2 && a.from < 2 + kPatches && a.to >= 2 && a.to < 2 + kPatches;
  });
  std::vector<uint8_t> source_side(p.network.nodes, 1);
  source_side[1] = 0;
  for (uint32_t v = 2; v < 2 + kPatches; ++v) source_side[v] = 0;
  const CutFacts light = facts_of(p, source_side);
  EXPECT_LT(light.smaller_side(), CutLimits{}.least_area);
  EXPECT_NE(why_refused(light, {}).find("share one open space"), std::string::npos);
  p.weight.assign(p.network.nodes, 1);
  const CutFacts weighed = facts_of(p, source_side);
  EXPECT_NEAR(weighed.side[1].weight, static_cast<double>(kPatches) / p.network.nodes, 0.1);
  EXPECT_GE(weighed.smaller_side(), CutLimits{}.least_area);
}

TEST(series_cut, finds_every_door_of_a_row_in_the_lights_order) {
  for (const std::vector<int64_t>& doors :
       {std::vector<int64_t>{400}, {400, 300}, {300, 400}, {350, 300, 400, 200}}) {
    const PatchNetwork p = rooms_in_row(doors);
    const SeriesCut cut = series_cut(p, 8, {});
    EXPECT_TRUE(cut.bottleneck) << cut.reason;
    EXPECT_EQ(cut.cuts.size(), doors.size());
    EXPECT_EQ(cut.drops, doors.size());
    EXPECT_EQ(cut.passed, 0u);
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

// The lamp's patches are those of the last room; `begun` walks begin on each, `lit` hit each.
CutFacts of_lamp_before_a_door(double begun, double lit) {
  PatchNetwork p = rooms_in_row({130000});
  p.begun.assign(p.network.nodes, 0);
  p.lit = p.viewed = p.begun;
  for (uint32_t v = 2 + kPatches; v < p.network.nodes; ++v) p.begun[v] = begun, p.lit[v] = lit;
  return facts_of(p, max_flow(p.network).source_side);
}

// 0.13 of each patch's rays pass the door: 130000 / 20 / 50000.
TEST(cut_facts, a_lamp_that_shines_through_its_opening_needs_no_portal) {
  CutLimits limits;
  limits.largest_conductance = 0.3;
  const CutFacts own = of_lamp_before_a_door(5, 10), others = of_lamp_before_a_door(1, 10);
  EXPECT_NEAR(own.straight.value_or(0), 1.0 / 3, 1e-9);
  EXPECT_NEAR(own.seen.value_or(0), 0.13, 1e-9);
  EXPECT_EQ(why_refused(own, limits).find("the lamp stands in its own opening: 33 %"), 0u);
  EXPECT_NEAR(others.straight.value_or(0), 1.0 / 11, 1e-9);  // twin: most light is scattered first
  EXPECT_EQ(why_refused(others, limits), "");
  CutFacts hidden = own;  // twin: sampling the lamp rarely finds the opening
  hidden.seen = 0.05;
  EXPECT_EQ(why_refused(hidden, limits), "");
  CutFacts dark = others;
  dark.carried = 0.005;
  EXPECT_EQ(why_refused(dark, limits).find("by the network only 0.5 % of the light"), 0u);
}

// Two rooms are the light's and this camera's; a third, on the other side of either, is only
// another camera's.
TEST(camera_cut, finds_what_a_network_of_this_camera_alone_gives) {
  for (const bool behind_the_lamp : {true, false}) {
    const SeriesCut alone = series_cut(rooms_in_row({behind_the_lamp ? 400 : 300}), 8, {});
    PatchNetwork p = rooms_in_row({400, 300});
    p.begun = p.lit = p.viewed = std::vector<double>(p.network.nodes, 0);
    const auto in_room = [](uint32_t v, uint32_t r) {
      return v >= 2 + r * kPatches && v < 2 + (r + 1) * kPatches;
    };
    const uint32_t camera = behind_the_lamp ? 0 : 1, lamp = camera + 1;
    std::erase_if(p.network.arcs, [](const FlowArc& a) { return a.from == 0 || a.to == 1; });
    for (uint32_t v = 2; v < p.network.nodes; ++v) {
      if (in_room(v, camera)) p.viewed[v] = 1, p.network.arcs.push_back({v, 1, 50000});
      if (in_room(v, lamp)) p.lit[v] = 1, p.network.arcs.push_back({0, v, 50000});
    }
    const SeriesCut cut = camera_cut(p, 8, {});
    ASSERT_EQ(cut.cuts.size(), alone.cuts.size());
    EXPECT_EQ(cut.cuts[0].flow, alone.cuts[0].flow);
    EXPECT_NEAR(cut.cuts[0].facts.conductance, alone.cuts[0].facts.conductance, 1e-12);
    EXPECT_NEAR(cut.cuts[0].facts.side[0].area, 0.5, 1e-12);
    EXPECT_EQ(regions(p, cut), behind_the_lamp ? (std::vector<uint32_t>{1, 0, 0})
                                               : (std::vector<uint32_t>{1, 1, 0}));
    // Twin: to the whole network the third room belongs.
    EXPECT_GT(std::abs(series_cut(p, 8, {}).cuts[0].facts.side[0].area - 0.5), 0.1);
  }
}

TEST(series_cut, tells_rooms_apart_that_light_and_camera_both_reach) {
  // A wide arch: the arcs of all terminals are saturated.
  PatchNetwork p = rooms_in_row({40000}, 50000 / kPatches);
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    const bool beyond = v < 2 + kPatches;
    p.network.arcs.push_back(beyond ? FlowArc{0, v, 50000} : FlowArc{v, 1, 50000});
  }
  EXPECT_FALSE(series_cut(p, 8, {}).bottleneck);
  p.lit.assign(p.network.nodes, 0);
  p.viewed = p.lit;
  for (uint32_t v = 2; v < p.network.nodes; ++v) {
    const bool beyond = v < 2 + kPatches;
    p.lit[v] = beyond ? 500 : 1000;
    p.viewed[v] = beyond ? 1000 : 500;
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
  EXPECT_LT(std::min(cut.cuts[0].facts.side[0].area, cut.cuts[0].facts.side[1].area), 0.03);
}

TEST(series_cut, a_terminal_that_reaches_nothing_is_told) {
  PatchNetwork dark = rooms_in_row({400}), blind = dark;
  std::erase_if(dark.network.arcs, [](const FlowArc& a) { return a.from == 0; });
  std::erase_if(blind.network.arcs, [](const FlowArc& a) { return a.to == 1; });
  EXPECT_EQ(series_cut(dark, 8, {}).reason, "no light reaches a surface");
  EXPECT_EQ(series_cut(blind, 8, {}).reason, "the camera sees no surface");
}

}  // namespace tdpt::series_cut_test
