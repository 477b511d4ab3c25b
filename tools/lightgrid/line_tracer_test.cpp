// Embree, the Vulkan device and the scalar build of its kernels compared: the same lines, the same
// counts. Runs on lavapipe with validation (tdpt_software_vulkan in CMakeLists.txt).
#include "tools/lightgrid/line_tracer.h"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "libcommon/gpu/device.h"
#include "libcommon/scene/sky_bins.h"
#include "libcommon/testing/scenes/sheet.h"
#include "libcommon/trace/tracer.h"
#include "shaders/shared/rng.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/testing/perfect_cut.h"
#include "tools/lightgrid/testing/scalar_lines.h"

namespace tdpt::line_tracer_test {

constexpr uint64_t kSeed = 0x1234'5678'9abc'def0;

// A scene cut in two by a plane, and the grid around it.
struct Case {
  std::string name;
  Scene scene;
  CutFile cut;
  LineTables tables;
  LightGrid grid;

  Case(std::string n, Scene s, int resolution, const std::function<bool(const Vec3d&)>& is_source)
      : name(std::move(n)), scene(std::move(s)) {
    open_glass(scene);
    cut = testing::perfect_cut(scene, 30000, is_source);
    tables = make_line_tables(scene, cut, "a.cut");
    grid = empty_grid(scene, resolution);
  }
};

// Cut across its longest side.
Case halved(const std::string& name, const Scene& scene, int resolution) {
  const LightGrid box = empty_grid(scene, 64);
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (box.dim[static_cast<size_t>(c)] > box.dim[static_cast<size_t>(axis)]) axis = c;
  const double middle = box.origin[axis] + 32.4 * box.voxel;
  return {name, scene, resolution, [=](const Vec3d& p) { return p[axis] > middle; }};
}

// Cut at its wall.
Case two_rooms(const Scene& scene = testing::two_rooms_scene(), int resolution = 64) {
  return {"two rooms", scene, resolution, [](const Vec3d& p) { return p.x > 2.05; }};
}

// Two rooms without a ceiling under a sky, whose bins are connected to the upward faces in one of
// them.
Case under_a_sky() {
  Scene scene = testing::two_rooms_scene();
  std::erase_if(scene.triangles, [&](const Triangle& t) {
    const auto y = [&](size_t k) {
      return scene.frame.to_metres(Vec3d(scene.positions[t.vertex[k]])).y;
    };
    return std::min({y(0), y(1), y(2)}) > 1.995;
  });
  scene.smooth.clear();
  Case c = two_rooms(scene);
  c.name = "under a sky";
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

std::vector<Case> cases() {
  const auto file = [](const char* name) {
    return read_gltf(TDPT_TESTDATA "/scenes/" + std::string(name) + ".glb");
  };
  const Scene room = testing::two_rooms_scene();
  Scene flat = room, tiny = room, degenerate = room;
  for (Vec3f& p : flat.positions) p.y *= 0.01f;  // one voxel high
  for (Vec3f& p : tiny.positions) p *= 1e-5f;
  for (const Triangle& t : room.triangles) {  // each twice, and some without area
    const auto [a, b, c] = t.vertex;
    degenerate.triangles.push_back(t);
    degenerate.triangles.push_back({{a, a, b}, t.material});
    degenerate.triangles.push_back({{c, c, c}, t.material});
  }
  std::vector<Case> all{two_rooms(),
                        under_a_sky(),
                        halved("door ajar", file("door-ajar"), 128),
                        halved("window", file("window"), 256),
                        halved("flat", flat, 37),
                        halved("tiny", tiny, 37),
                        halved("degenerate", degenerate, 37)};
  for (const size_t i : {0, 3}) {  // without a texture and with one
    const Material sheet = testing::sheet_materials()[i];
    all.push_back(two_rooms(testing::with_sheet(sheet, testing::small_image()), 16));
    all.back().name = "a sheet that is there with a probability";
  }
  return all;
}

// Results of a tracer for segments and tries.
struct Outcome {
  TracedLines segments, tries;
  std::vector<uint32_t> count;
  std::vector<Vec3d> direction;
};

Outcome outcome_of(LineTracer& tracer, const LightGrid& grid, uint32_t segments) {
  Outcome out;
  TracedLines first, second;
  tracer.between_pivots(0, 7, segments / 3, first);
  tracer.clear();  // forgets them
  tracer.between_pivots(0, 0, segments / 3, first);
  tracer.between_pivots(0, segments / 3, segments - segments / 3, second);
  out.segments = first;
  out.segments.ends.insert(out.segments.ends.end(), second.ends.begin(), second.ends.end());
  out.segments.fate.insert(out.segments.fate.end(), second.fate.begin(), second.fate.end());
  tracer.counts(out.count);
  out.direction.resize(grid.count.size());
  tracer.take_directions(out.direction);
  // Lines in any direction through the middles of lines that connect the sides, and some tries
  // without direction.
  std::vector<shader::LineTry> tries(4096);
  for (size_t i = 0; i < tries.size(); ++i) {
    const shader::LineEnds& line = out.segments.ends[i % out.segments.size()];
    Rng rng(5, 0, i);
    const double u = rng.uniform(), v = rng.uniform();
    tries[i].place = (line.light + line.camera) * 0.5f;
    if (i % 16 == 3) continue;
    if (i % 16 == 5)
      tries[i].direction[static_cast<int>(i / 16 % 3)] = 1;
    else
      tries[i].direction = Vec3f(cosine_hemisphere(u, v)) * (i % 2 ? 1.0f : -1.0f);
  }
  tracer.through(0, 7, tries, out.tries);
  std::vector<uint32_t> after;
  tracer.counts(after);
  EXPECT_TRUE(after == out.count);  // tries are not counted
  return out;
}

size_t differences(const TracedLines& a, const TracedLines& b) {
  EXPECT_EQ(a.size(), b.size());
  size_t n = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    n += a.fate[i] != b.fate[i];
    if (a.fate[i] == LineFate::none || b.fate[i] == LineFate::none) continue;
    n += a.ends[i].light != b.ends[i].light || a.ends[i].camera != b.ends[i].camera ||
         a.ends[i].light_face != b.ends[i].light_face ||
         a.ends[i].camera_face != b.ends[i].camera_face;
  }
  return n;
}

size_t joining(const TracedLines& lines) {
  return static_cast<size_t>(std::count(lines.fate.begin(), lines.fate.end(), LineFate::joins));
}

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(differences(a.segments, b.segments), 0u);
  EXPECT_EQ(differences(a.tries, b.tries), 0u);
  EXPECT_TRUE(a.count == b.count);
  EXPECT_TRUE(a.direction == b.direction);
  // The test must have something to compare.
  EXPECT_GT(joining(a.segments), 20u);
  EXPECT_GE(joining(a.tries), 10u);
  EXPECT_GT(std::count(a.tries.fate.begin(), a.tries.fate.end(), LineFate::same_side), 10);
}

TEST(LineTracers, device_and_twin_count_the_same_and_embree_nearly) {
  const char* on = getenv("TDPT_VULKAN_VALIDATION");
  ASSERT_TRUE(on && std::string(on) == "1") << "run it with ctest, or set what ctest sets";
  const gpu::Device device = gpu::Device::open();
  constexpr uint32_t kLines = 6000;
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto of_device = make_gpu_lines(device, c.scene, c.tables, c.grid, kSeed);
    const auto scalar = make_scalar_lines(c.scene, c.tables, c.grid, kSeed);
    const auto embree = make_embree_lines(c.scene, c.tables, c.grid, kSeed);
    const Outcome outcome = outcome_of(*scalar, c.grid, kLines);
    expect_same(outcome_of(*of_device, c.grid, kLines), outcome);
    // In one of 10 000 lines; under a sky, whose dome makes everything else 32 times as large, in
    // one of 3000.
    const size_t unlike =
        differences(outcome_of(*embree, c.grid, kLines).segments, outcome.segments);
    EXPECT_LE(unlike, c.name == "under a sky" ? 3u : 1u) << unlike;
  }
}

TEST(LineTracers, device_does_the_same_again_and_in_short_submissions) {
  const gpu::Device device = gpu::Device::open();
  const Case c = two_rooms();
  const auto tracer = make_gpu_lines(device, c.scene, c.tables, c.grid, kSeed, 777);
  const Outcome first = outcome_of(*tracer, c.grid, 3000);
  expect_same(first, outcome_of(*tracer, c.grid, 3000));
  const auto whole = make_gpu_lines(device, c.scene, c.tables, c.grid, kSeed);
  expect_same(first, outcome_of(*whole, c.grid, 3000));
}

// Another seed, a scene that is moved by a 256th of a voxel, and a sheet in the way are seen.
TEST(LineTracers, twin_other_lines_differ) {
  const Case c = two_rooms();
  const auto lines_of = [&](const Scene& scene, uint64_t seed) {
    return outcome_of(*make_scalar_lines(scene, c.tables, c.grid, seed), c.grid, 10000);
  };
  const Outcome lines = lines_of(c.scene, kSeed), others = lines_of(c.scene, kSeed + (1ull << 32));
  EXPECT_GT(differences(lines.segments, others.segments), 5000u);
  EXPECT_FALSE(lines.count == others.count);
  Scene moved = c.scene;
  for (Vec3f& p : moved.positions) p.x += 1 / 256.0f;
  EXPECT_GT(differences(lines.segments, lines_of(moved, kSeed).segments), 10u);
  const Case sheet =
      two_rooms(testing::with_sheet(testing::sheet_materials()[0], testing::small_image()));
  const auto behind = make_scalar_lines(sheet.scene, sheet.tables, sheet.grid, kSeed);
  EXPECT_LT(joining(outcome_of(*behind, sheet.grid, 10000).segments),
            0.9 * joining(lines.segments));
}

// A line from the sky hits what a plain ray hits, and is clipped to the grid on its own way; lines
// that pass the grid do not accumulate at its border.
TEST(LinesUnderASky, are_free_and_end_at_the_grid) {
  const Case c = under_a_sky();
  const auto tracer = make_embree_lines(c.scene, c.tables, c.grid, kSeed);
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
    const LightLine line = tracer->in_metres(c.scene, c.grid, 0, ends);
    EXPECT_LT(length(line.light - line.camera), 6);  // metres
    EXPECT_GT(dot(normalize(line.light - line.camera), w), 1 - 1e-6);
    ++seen;
  }
  EXPECT_GT(seen, 100u);
  EXPECT_LE(met_on_the_way, seen / 500);  // along edges
  // Every line in the grid came through the air of the top layer.
  std::vector<uint32_t> count;
  tracer->counts(count);
  EXPECT_GT(std::count_if(count.begin(), count.end(), [](uint32_t n) { return n > 0; }),
            c.grid.dim[0] * c.grid.dim[1] / 4);
}

}  // namespace tdpt::line_tracer_test
