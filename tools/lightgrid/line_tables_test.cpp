#include <algorithm>

#include <gtest/gtest.h>

#include "libcommon/scene/sky_bins.h"
#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/line_tables.h"
#include "tools/lightgrid/testing/lines.h"

namespace tdpt::testing::line_tables_test {

// Lines from the sky: Embree, the Vulkan device and the scalar build of its kernels compared.

// Two rooms without a ceiling under a sky, whose bins are connected to the upward faces in one of
// them.
Case under_a_sky() {
  Scene scene = two_rooms_scene();
  std::erase_if(scene.triangles, [&](const Triangle& t) {
    const auto y = [&](size_t k) {
      return scene.frame.to_metres(Vec3d(scene.positions[t.vertex[k]])).y;
    };
    return std::min({y(0), y(1), y(2)}) > 1.995;
  });
  scene.smooth.clear();
  Case c = two_rooms(scene);
  add_sky_dome(c.scene);
  const auto surfaces = static_cast<uint32_t>(c.cut.patches.size());
  for (int32_t bin = 0; bin < int32_t{kSkyBins}; ++bin) {
    Patch sky{};
    sky.node = 10000 + static_cast<uint32_t>(bin);
    sky.sky = bin;
    c.cut.patches.push_back(sky);
    c.cut.sides.push_back(0);
    for (uint32_t i = 0; i < surfaces; ++i)
      if (c.cut.sides[i] == 1 && c.cut.patches[i].normal.y > 0.9)
        c.cut.arcs.push_back({surfaces + static_cast<uint32_t>(bin), i, 10});
  }
  c.tables = make_line_tables(c.scene, c.cut, "a.cut");
  return c;
}

TEST_F(LineTracers, device_and_twin_count_the_same_under_a_sky) {
  const Case c = under_a_sky();
  const LightGrid grid = empty_grid(c.scene, 64);
  const Outcome scalar = on_scalar_build(c, grid, 20000);
  expect_same(on_device(c, grid, 20000), scalar);
  size_t from_sky = 0;
  for (size_t i = 0; i < scalar.segments.size(); ++i)
    from_sky += scalar.segments.fate[i] == LineFate::joins &&
                scalar.segments.ends[i].light_face >= c.tables.first_sky_face;
  EXPECT_GT(from_sky, 100u);
  // Lines that pass the grid do not accumulate at its border: every line in it came through the air
  // of the top layer.
  const size_t layer = static_cast<size_t>(grid.dim[0]) * static_cast<size_t>(grid.dim[1]);
  EXPECT_GT(
      std::count_if(scalar.count.begin(), scalar.count.end(), [](uint32_t n) { return n > 0; }),
      static_cast<std::ptrdiff_t>(layer / 4));
}

// The scalar build's triangles are as exact as before; because of the dome everything else is 32
// times as large.
TEST(LinesOfEmbree, differ_from_the_scalar_build_in_one_of_3000_at_most_under_a_sky) {
  const Case c = under_a_sky();
  const LightGrid grid = empty_grid(c.scene, 64);
  constexpr uint32_t kLines = 40000;
  const Outcome embree =
      outcome_of(*make_embree_lines(c.scene, c.tables, grid, kSeed), grid, kLines);
  const Outcome scalar =
      outcome_of(*make_scalar_lines(c.scene, c.tables, grid, kSeed), grid, kLines);
  EXPECT_LE(differences(embree.segments, scalar.segments), kLines / 3000);
}

// A line from the sky hits what a plain ray hits, and is clipped to the grid on its own way.
TEST(LinesUnderASky, are_free_and_end_at_the_grid) {
  const Case c = under_a_sky();
  const LightGrid grid = empty_grid(c.scene, 64);
  const auto tracer = make_embree_lines(c.scene, c.tables, grid, kSeed);
  TracedLines lines;
  tracer->between_pivots(0, 0, 20000, lines);
  const Tracer rays(c.scene);
  size_t seen = 0, met_on_the_way = 0;
  for (size_t i = 0; i < lines.size(); ++i) {
    const shader::LineEnds& ends = lines.ends[i];
    if (lines.fate[i] != LineFate::joins || ends.light_face < c.tables.first_sky_face) continue;
    const Vec3d w = normalize(Vec3d(ends.light) - Vec3d(ends.camera));
    Hit hit;
    const TriangleShape s = shape_of(c.scene, ends.camera_face / 2);
    ASSERT_TRUE(
        rays.closest({Vec3d(ends.camera), ends.camera_face & 1 ? -s.normal : s.normal}, w, hit));
    met_on_the_way += hit.triangle < c.scene.dome;
    const LightLine line = tracer->in_metres(c.scene, grid, 0, ends);
    EXPECT_LT(length(line.light - line.camera), 6);  // metres
    EXPECT_GT(dot(normalize(line.light - line.camera), w), 1 - 1e-6);
    ++seen;
  }
  EXPECT_GT(seen, 100u);
  EXPECT_LE(met_on_the_way, seen / 500);  // along edges
}

}  // namespace tdpt::testing::line_tables_test
