// For tests: scenes cut in two, and the results of each kind of line tracer for the same lines.
#pragma once
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/gpu/device.h"
#include "libcommon/testing/scenes/sheet.h"
#include "shaders/shared/rng.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/line_tracer.h"
#include "tools/lightgrid/testing/perfect_cut.h"
#include "tools/lightgrid/testing/scalar_lines.h"

namespace tdpt::testing {

inline constexpr uint64_t kSeed = 0x1234'5678'9abc'def0;

// A scene cut in two by a plane.
struct Case {
  Scene scene;
  CutFile cut;
  LineTables tables;

  Case(Scene s, const std::function<bool(const Vec3d&)>& is_source) : scene(std::move(s)) {
    open_glass(scene);
    cut = perfect_cut(scene, 30000, is_source);
    tables = make_line_tables(scene, cut, "a.cut");
  }
};

// Cut across its longest side.
inline Case halved(const Scene& scene) {
  const LightGrid box = empty_grid(scene, 64);
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (box.dim[static_cast<size_t>(c)] > box.dim[static_cast<size_t>(axis)]) axis = c;
  const double middle = box.origin[axis] + 32.4 * box.voxel;
  return {scene, [=](const Vec3d& p) { return p[axis] > middle; }};
}

inline Case room(const std::string& name) {
  return halved(read_gltf(TDPT_TESTDATA "/scenes/" + name + ".glb"));
}

// Cut at its wall.
inline Case two_rooms(const Scene& scene = two_rooms_scene()) {
  return {scene, [](const Vec3d& p) { return p.x > 2.05; }};
}

// Results of a tracer for segments and tries.
struct Outcome {
  TracedLines segments, tries;
  std::vector<uint32_t> count;
  std::vector<Vec3d> direction;
};

inline Outcome outcome_of(LineTracer& tracer, const LightGrid& grid, uint32_t segments) {
  Outcome out;
  tracer.clear();
  TracedLines first, second;
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

inline size_t differences(const TracedLines& a, const TracedLines& b) {
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

inline size_t joining(const TracedLines& lines) {
  return static_cast<size_t>(std::count(lines.fate.begin(), lines.fate.end(), LineFate::joins));
}

inline void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(differences(a.segments, b.segments), 0u);
  EXPECT_EQ(differences(a.tries, b.tries), 0u);
  EXPECT_TRUE(a.count == b.count);
  EXPECT_TRUE(a.direction == b.direction);
  // The test must have something to compare.
  EXPECT_GT(joining(a.segments), 20u);
  EXPECT_GE(joining(a.tries), 10u);
  EXPECT_GT(std::count(a.tries.fate.begin(), a.tries.fate.end(), LineFate::same_side), 10);
}

class LineTracers : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* on = getenv("TDPT_VULKAN_VALIDATION");
    ASSERT_TRUE(on && std::string(on) == "1") << "run it with ctest, or set what ctest sets";
    device = std::make_unique<gpu::Device>(gpu::Device::open());
  }
  Outcome on_device(const Case& c, const LightGrid& grid, uint32_t n, uint64_t seed = kSeed,
                    uint32_t most_lines = 1u << 18) {
    const auto tracer = make_gpu_lines(*device, c.scene, c.tables, grid, seed, most_lines);
    return outcome_of(*tracer, grid, n);
  }
  Outcome on_scalar_build(const Case& c, const LightGrid& grid, uint32_t n) {
    return outcome_of(*make_scalar_lines(c.scene, c.tables, grid, kSeed), grid, n);
  }
  std::unique_ptr<gpu::Device> device;
};

}  // namespace tdpt::testing
