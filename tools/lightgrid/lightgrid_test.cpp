#include "tools/lightgrid/lightgrid.h"

#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "tools/lightgrid/testing/perfect_cut.h"

namespace tdpt::lightgrid_test {

Scene two_rooms() {
  return read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
}
CutFile door_cut(const Scene& scene) {
  return testing::perfect_cut(scene, 60000, [](const Vec3d& p) { return p.x > 2.05; });
}
LightGridOptions quick() {
  LightGridOptions o;
  o.resolution = 48;
  o.samples = 1 << 17;
  o.lines = 2000;
  return o;
}

TEST(Air, TriangleAgainstBox) {
  const Vec3d half(1);
  EXPECT_TRUE(triangle_touches_box({0, 0, 0}, {5, 0, 0}, {0, 5, 0}, half));
  EXPECT_TRUE(triangle_touches_box({-9, -9, 0.9}, {9, -9, 0.9}, {0, 9, 0.9}, half));
  EXPECT_FALSE(triangle_touches_box({-9, -9, 1.1}, {9, -9, 1.1}, {0, 9, 1.1}, half));
  EXPECT_TRUE(triangle_touches_box({2, 0, 0}, {0, 2, 0}, {0, 0, 2}, half));
  // Its box and its plane overlap the box, but its edge passes beside the corner.
  EXPECT_FALSE(triangle_touches_box({2.1, 0, 0}, {0, 2.1, 0}, {3, 3, 0}, half));
  EXPECT_TRUE(triangle_touches_box({1.9, 0, 0}, {0, 1.9, 0}, {3, 3, 0}, half));
}

TEST(Air, ConservativeAndExact) {
  Scene scene;
  for (uint64_t i = 0; i < 60; ++i) {
    Rng rng(3, 3, i);
    const float x = rng.uniform_float(), y = rng.uniform_float(), z = rng.uniform_float();
    scene.positions.push_back({2 * x - 1, 2 * y - 1, 2 * z - 1});
  }
  for (uint32_t t = 0; t < 20; ++t) scene.triangles.push_back({{3 * t, 3 * t + 1, 3 * t + 2}, 0});
  LightGrid grid;
  grid.origin = {-1, -1, -1};
  grid.voxel = 2.0 / 11;
  grid.dim = {11, 11, 11};
  grid.count.assign(1331, 0);
  mark_air(scene, grid);
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i) {
        const Vec3d middle = grid.origin + Vec3d{i + 0.5, j + 0.5, k + 0.5} * grid.voxel;
        bool touched = false;
        for (uint32_t t = 0; t < 20; ++t)
          touched = touched || triangle_touches_box(Vec3d(scene.vertex(t, 0)) - middle,
                                                    Vec3d(scene.vertex(t, 1)) - middle,
                                                    Vec3d(scene.vertex(t, 2)) - middle,
                                                    Vec3d(0.5 * grid.voxel));
        EXPECT_EQ(grid.air[grid.index(i, j, k)], touched ? 0 : 1) << i << ' ' << j << ' ' << k;
      }
}

// Share of lines through the hole of two-rooms.glb, with a tolerance of a millimetre.
double share_through_hole(const LightGrid& grid) {
  double through = 0;
  for (const LightLine& l : grid.lines) {
    const Vec3d d = l.camera - l.light;
    const double t = (2.05 - l.light.x) / d.x;
    const Vec3d p = l.light + d * t;
    through += d.x < 0 && t > 0 && t < 1 && std::abs(p.y - 1) < 0.126 && std::abs(p.z) < 0.126;
  }
  return through / static_cast<double>(grid.lines.size());
}

TEST(LightGrid, LightPassesTheHole) {
  const Scene scene = two_rooms();
  LightGridReport report;
  const LightGrid grid = make_light_grid(scene, door_cut(scene), "a.cut", quick(), report);
  ASSERT_TRUE(grid.bottleneck);
  EXPECT_GT(grid.lines.size(), 500u);
  EXPECT_GT(share_through_hole(grid), 0.6);  // the rest ends on the jambs
  const auto fullest = static_cast<size_t>(std::max_element(grid.count.begin(), grid.count.end()) -
                                           grid.count.begin());
  const Vec3d at = centre_of(grid, fullest);
  EXPECT_NEAR(at.x, 2.05, 0.2);
  EXPECT_NEAR(at.y, 1, 0.2);
  EXPECT_NEAR(at.z, 0, 0.2);
  EXPECT_LT(grid.direction[fullest].x, -0.5f);
  for (size_t i = 0; i < grid.count.size(); ++i)
    if (!grid.air[i]) {
      EXPECT_EQ(grid.count[i], 0);
    }
  EXPECT_GT(report.all().joined, 0.2 * static_cast<double>(report.all().tried));
  // Twin: a "cut" through the middle of a room has lines, but no support.
  const CutFile wrong =
      testing::perfect_cut(scene, 60000, [](const Vec3d& p) { return p.x > 1.0; });
  LightGridReport other;
  EXPECT_LT(share_through_hole(make_light_grid(scene, wrong, "a.cut", quick(), other)), 0.3);
}

TEST(LightGrid, AWideGroundDoesNotCoarsenTheVoxels) {
  Scene scene = two_rooms();
  const CutFile cut = door_cut(scene);
  EXPECT_EQ(reach_of_cut(scene, cut).size(), box_of(scene).size());
  // Fifty times as wide, below both rooms.
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const float z : {-50.0f, 50.0f})
    for (const float x : {-50.0f, 50.0f}) scene.positions.push_back({x, -3, z});
  scene.triangles.push_back({{first, first + 1, first + 3}, 0});
  LightGridReport report;
  const LightGrid grid = make_light_grid(scene, cut, "a.cut", quick(), report);
  EXPECT_LT(grid.voxel, 1.3 * empty_grid(two_rooms(), quick().resolution).voxel);
  EXPECT_GT(share_through_hole(grid), 0.6);
  // Twin: with the scene's box they would be much larger.
  EXPECT_GT(empty_grid(scene, quick().resolution).voxel, 10 * grid.voxel);
}

TEST(LightGrid, LinesThatLeaveTheGridEndThere) {
  LightGrid grid;
  grid.origin = {-1, -1, -1};
  grid.voxel = 0.5;
  grid.dim = {4, 4, 4};
  const auto clipped = [&](LightLine line) -> std::optional<LightLine> {
    return clip_to(grid, line) ? std::optional(line) : std::nullopt;
  };
  const auto through = clipped({{-3, 0, 0}, {5, 0, 0}});
  ASSERT_TRUE(through);
  EXPECT_NEAR(length(through->light - Vec3d(-1, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(length(through->camera - Vec3d(1, 0, 0)), 0, 1e-12);
  const auto out = clipped({{0, 0, 0}, {4, 4, 2}});
  ASSERT_TRUE(out);
  EXPECT_EQ(length(out->light), 0);
  EXPECT_NEAR(length(out->camera - Vec3d(1, 1, 0.5)), 0, 1e-12);
  // Lines within stay bit-identical; nothing remains of those outside.
  const LightLine within{{0.1, 0.2, 0.3}, {0.3, -0.7, 0.9}};
  EXPECT_EQ(clipped(within)->camera.y, within.camera.y);
  EXPECT_FALSE(clipped({{2, 0, 0}, {2, 1, 0}}));
  EXPECT_FALSE(clipped({{3, 0, 0}, {0, 3, 0}}));
}

TEST(LightGrid, SettlesOrSaysThatItDidNot) {
  const Scene scene = two_rooms();
  const CutFile cut = door_cut(scene);
  LightGridOptions options = quick();
  LightGridReport few, loose, stopped;
  options.samples = 1000;
  make_light_grid(scene, cut, "a.cut", options, few);
  EXPECT_FALSE(few.all().settled);
  EXPECT_EQ(few.all().drawn, 1000u);
  options.samples = 1 << 22;
  options.tolerance = 0.2;
  make_light_grid(scene, cut, "a.cut", options, loose);
  EXPECT_TRUE(loose.all().settled);
  EXPECT_LT(loose.all().drawn, options.samples);
  // Stopped, it keeps what it has.
  options.tolerance = 0;
  const LightGrid grid =
      make_light_grid(scene, cut, "a.cut", options, stopped, {{}, [] { return true; }});
  EXPECT_TRUE(stopped.stopped);
  EXPECT_LT(stopped.all().drawn, options.samples);
  ASSERT_EQ(stopped.cuts.size(), 1u);
  EXPECT_EQ(stopped.cuts[0].batches, 1u);
  EXPECT_FALSE(stopped.cuts[0].settled);
  EXPECT_EQ(stopped.cuts[0].lines, grid.lines.size());
  EXPECT_FALSE(grid.lines.empty());
}

// Reports every line as blocked; records its calls.
class BlockedTracer : public LineTracer {
 public:
  BlockedTracer(const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed,
                uint64_t& most)
      : LineTracer(scene, tables, grid, seed), most_(most) {}
  void clear() override {}
  void counts(std::vector<uint32_t>&) override {}
  void take_directions(std::vector<Vec3d>&) override { summed_ = 0; }

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines& out) override {
    EXPECT_EQ(p.first, next_);
    next_ += p.count;
    most_ = std::max(most_, summed_ += p.count);
    std::fill(out.fate.begin(), out.fate.end(), LineFate::none);
  }
  void trace_tries(const shader::LightParameters&, std::span<const shader::LineTry>,
                   TracedLines&) override {
    ADD_FAILURE();
  }

 private:
  uint64_t summed_ = 0;
  uint32_t next_ = 0;
  uint64_t& most_;
};

TEST(LightGrid, TakesDirectionsBeforeTheyOverflow) {
  const Scene scene = two_rooms();
  LightGridOptions options = quick();
  options.samples = 3 * LIGHT_MOST_SUMMED + 1;
  LightGridReport report;
  uint64_t most = 0;
  make_light_grid(scene, door_cut(scene), "a.cut", options, report, {},
                  [&](const Scene& s, const LineTables& tables, const LightGrid& grid,
                      uint64_t seed) -> std::unique_ptr<LineTracer> {
                    return std::make_unique<BlockedTracer>(s, tables, grid, seed, most);
                  });
  EXPECT_EQ(report.all().drawn, options.samples);
  EXPECT_LE(most, uint64_t{LIGHT_MOST_SUMMED});
  EXPECT_GT(most, uint64_t{LIGHT_MOST_SUMMED} / 2);
  EXPECT_LT(LIGHT_MOST_SUMMED * LIGHT_DIRECTION_UNITS, 0x1p31f);
}

TEST(LightGrid, RefusesWhatDoesNotBelongTogether) {
  const Scene scene = two_rooms();
  CutFile cut = door_cut(scene);
  LightGridReport report;
  const auto message = [&] {
    try {
      make_light_grid(scene, cut, "room.cut", quick(), report);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  const std::string hash = cut.scene_hash;
  cut.scene_hash = "0";
  EXPECT_NE(message().find("room.cut: was made from another scene than "), std::string::npos);
  cut.scene_hash = hash;
  cut.patches[3].faces = {1u << 30};
  EXPECT_EQ(message(), "room.cut:patch 3: names triangle 536870912, but the scene has " +
                           std::to_string(scene.triangles.size()));
}

TEST(LightGrid, NoBottleneckIsAResult) {
  const Scene scene = two_rooms();
  CutFile cut = door_cut(scene);
  LightGridReport report;
  cut.bottleneck = false;
  cut.reason = "one side is nearly empty";
  EXPECT_EQ(make_light_grid(scene, cut, "a.cut", quick(), report).reason, cut.reason);
  cut.bottleneck = true;
  cut.arcs.clear();
  EXPECT_EQ(make_light_grid(scene, cut, "a.cut", quick(), report).reason,
            "no pair of the cut has any surface");
}

TEST(LightGrid, KeepsOnesOwnLinesAndCountsThem) {
  const Scene scene = two_rooms();
  LightGridOptions options = quick();
  options.own = {{{9, 9, 9}, {8, 8, 8}, 0}};  // outside of the grid
  LightGridReport report;
  const LightGrid none = make_light_grid(scene, door_cut(scene), "a.cut", options, report);
  EXPECT_FALSE(none.bottleneck);
  EXPECT_EQ(none.reason, "no line given lies in the grid");
  for (int i = 0; i < 40; ++i)  // through the middle of the hole
    options.own.push_back({{3.9, 0.9 + 0.005 * i, 0}, {0.2, 1, 0.1}, 0});
  const LightGrid grid = make_light_grid(scene, door_cut(scene), "a.cut", options, report);
  ASSERT_EQ(grid.lines.size(), 40u);
  for (size_t l = 0; l < 40; ++l) EXPECT_EQ(grid.lines[l].light, options.own[l + 1].light);
  EXPECT_EQ(report.fullest, 40);  // where they end
  EXPECT_TRUE(report.all().settled);
  EXPECT_EQ(grid.cuts[0].kept, 1);
  EXPECT_EQ(grid.flux_share, 1);
  for (size_t v = 0; v < grid.count.size(); ++v) {
    EXPECT_TRUE(grid.air[v] || grid.count[v] == 0);
    EXPECT_LE(length(grid.direction[v]), 1 + 1e-5f);
    EXPECT_TRUE(grid.count[v] == 0 || grid.direction[v].x < -0.9f);
  }
  size_t joins = 0;
  for (const Probe& probe : grid.probes) joins += probe.joins;
  EXPECT_GT(grid.probes.size(), 1000u);
  EXPECT_GT(joins, grid.probes.size() / 8);
}

}  // namespace tdpt::lightgrid_test
