#include "libcommon/formats/light_grid.h"

#include <cstring>

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/small_light_grid.h"

namespace tdpt::light_grid_test {

LightGrid read(const std::string& bytes) {
  return read_light_grid(bytes, "a.vdb");
}
/// The reader's error, without the file's name; "" if there is none.
std::string error_of(const std::string& bytes) {
  const std::string said = testing::refusal<InputError>([&] { read(bytes); });
  return said.substr(std::min(said.size(), sizeof "a.vdb"));
}

using testing::expect_same_lines;
LightGrid small() {
  return testing::small_light_grid();
}

TEST(LightGridFormat, ComesBackAsItWasWritten) {
  LightGrid g = small();
  g.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  g.cuts[1].camera = 1;
  g.flux_share = 0.75;
  const std::string bytes = light_grid_bytes(g);
  const LightGrid back = read(bytes);
  testing::expect_same_but_lines(back, g);
  expect_same_lines(back, g, 1e-6);
  const auto joins = [](const Probe& p) { return p.joins; };
  ASSERT_EQ(back.probes.size(), g.probes.size());
  EXPECT_EQ(std::count_if(back.probes.begin(), back.probes.end(), joins), 14);
  EXPECT_EQ(back.number_of_cameras(), 2u);
  EXPECT_EQ(back.camera_of(1), 1u);
  EXPECT_EQ(back.camera_of(7), 0u) << "unknown";
  EXPECT_EQ(back.provenance.lines, g.provenance.lines);
  EXPECT_TRUE(light_grid_bytes(g) == bytes) << "two writings differ";
}

// The same bits except for the order of lines; only viewers see another orientation.
TEST(LightGridFormat, StandsUprightOnDemandAndIsReadAsTheSame) {
  const LightGrid g = small();
  const std::string lying = light_grid_bytes(g), upright = light_grid_bytes(g, true);
  EXPECT_TRUE(lying.find("tdpt_z_up") == std::string::npos);
  ASSERT_TRUE(upright.find("tdpt_z_up") != std::string::npos);
  const LightGrid a = read(lying), b = read(upright);
  testing::expect_same_but_lines(a, b);
  expect_same_lines(b, a, 1e-15);
  ASSERT_EQ(a.probes.size(), b.probes.size());
  for (size_t i = 0; i < a.probes.size(); ++i)
    EXPECT_EQ(a.probes[i].line.camera, b.probes[i].line.camera);
  // A reader that confuses the two finds lines outside their box.
  std::string taken = upright;
  taken.replace(taken.find("tdpt_z_up"), 9, "tdpt_x_up").replace(21 + 14, 1, "4");
  EXPECT_EQ(error_of(taken), "grid lines: reaches out of its box");
}

TEST(LightGridFormat, NoBottleneckIsAFileToo) {
  LightGrid g;
  g.bottleneck = false;
  g.reason = "one side is empty";
  const LightGrid back = read(light_grid_bytes(g));
  EXPECT_FALSE(back.bottleneck);
  EXPECT_EQ(back.reason, "one side is empty");
  EXPECT_TRUE(back.lines.empty());
  EXPECT_TRUE(back.count.empty());
}

// What its header says is tested with light_tables.h, which has the same.
TEST(LightGridFormat, RefusesWhatIsNoLightGrid) {
  for (const char* text : {"", "hello, this is text"})
    EXPECT_NE(error_of(text).find("is no light grid in OpenVDB format"), std::string::npos);
  const auto expect_error = [](void (*spoil)(LightGrid&), const std::string& words) {
    LightGrid g = small();
    spoil(g);
    const std::string said = error_of(light_grid_bytes(g));
    EXPECT_EQ(said.find(words), 0u) << said;
  };
  expect_error([](LightGrid& g) { g.voxel = -1; }, "tdpt_light_grid:line 8: ");
  expect_error([](LightGrid& g) { g.cuts[0].conductance = 2; }, "tdpt_light_grid:line 10: ");
  expect_error([](LightGrid& g) { g.count[0] = -1; }, "grid count: holds -1");
  expect_error([](LightGrid& g) { g.direction[0].x = INFINITY; }, "grid direction: ");
  expect_error([](LightGrid& g) { g.lines[0].camera = g.lines[0].light; },
               "grid lines: holds a line that is no segment");
  expect_error([](LightGrid& g) { g.lines[0].share = 1e7; }, "grid lines: holds a line with");
  expect_error([](LightGrid& g) { g.lines[0].camera.y = 1e30; }, "grid lines: reaches out");
  expect_error([](LightGrid& g) { g.probes[0].line.cut = 64; }, "grid probes: holds a line of cut");
  const auto without_voxels = [](LightGrid& g) {
    g.dim = {0, 0, 0};
    g.count.clear(), g.air.clear(), g.direction.clear();
  };
  expect_error(without_voxels, "grid lines: reaches out");
}

// A file of another program: its identifier is not a hash of its bytes.
std::string foreign(std::string bytes) {
  return bytes.replace(21 + 14, 1, "4");
}

// A program without points saves a file of its own without lines.
TEST(LightGridFormat, HasEachOfItsGridsOnce) {
  const std::string good = foreign(light_grid_bytes(small()));
  EXPECT_EQ(error_of(replaced(good, "lines", "xines")).find(" has no grid lines"), 0u);
  EXPECT_EQ(error_of(replaced(good, "direction", "xirection")).find(" has no grid direction"), 0u);
  EXPECT_EQ(error_of(replaced(good, "lines", "count")).find("grid count: again"), 0u);
  EXPECT_EQ(error_of(replaced(good, "tdpt_light", "tdpT_light")).find("tdpt_light_grid: is miss"),
            0u);
  LightGrid none = small();
  none.lines.clear(), none.probes.clear();
  EXPECT_EQ(error_of(light_grid_bytes(none)), "") << "there may be no line";
}

// `bytes` of a file of one voxel with other numbers of them.
std::string of_voxels(std::string bytes, const std::string& side) {
  const std::string one = " 0.3 1 1 1\n";
  const size_t at = bytes.find(one);
  const std::string header = " 0.3 " + side + " " + side + " " + side + "\n";
  // The header is preceded by its length.
  const size_t length_at = bytes.find("# tdpt light grid") - sizeof(int32_t);
  int32_t length = 0;
  std::memcpy(&length, &bytes[length_at], sizeof length);
  length += static_cast<int32_t>(header.size() - one.size());
  std::memcpy(&bytes[length_at], &length, sizeof length);
  return bytes.replace(at, one.size(), header);
}

TEST(LightGridFormat, OneVoxelAndTooManyOfThem) {
  LightGrid g = small();
  g.dim = {1, 1, 1};
  g.count = {3}, g.air = {1}, g.direction = {{1, 0, 0}};
  g.lines = {{g.origin, g.origin + Vec3d(0.25), 0}}, g.probes.clear();
  const LightGrid back = read(light_grid_bytes(g));
  EXPECT_EQ(back.count, g.count);
  expect_same_lines(back, g, 1e-6);
  const auto error_with = [&](const std::string& side) {
    return error_of(foreign(of_voxels(light_grid_bytes(g), side)));
  };
  EXPECT_EQ(error_with("1024").find("tdpt_light_grid:line 8: 1073741824 voxels"), 0u);
  EXPECT_EQ(error_with("512").find("tdpt_light_grid: 134217728 voxels, but 1 hold air"), 0u);
}

TEST(LightGridFormat, TakesNoMoreThanTheLimitOfMemory) {
  LightGrid g = small();
  g.dim = {64, 64, 64};
  const size_t n = size_t{64} * 64 * 64;
  g.count.assign(n, 1), g.air.assign(n, 1), g.direction.assign(n, {1, 0, 0});
  const std::string bytes = light_grid_bytes(g);
  const uint64_t machine = memory_limit();
  limit_memory(1 << 20);
  EXPECT_EQ(error_of(bytes).find("tdpt_light_grid: 262144 voxels take 4.25 MiB"), 0u);
  limit_memory(machine);
  EXPECT_EQ(error_of(bytes), "");
}

// Points with equal values take no space in the file.
TEST(LightGridFormat, LinesTakeRoomInTheFile) {
  LightGrid g = small();
  g.lines.assign(150'000, g.lines[0]);
  const std::string bytes = light_grid_bytes(g);
  ASSERT_LT(bytes.size(), 80'000u);
  EXPECT_EQ(error_of(bytes).find("grid lines: 150000 lines, expected at most"), 0u);
}

TEST(LightGridFormat, DamageShowsBeforeOpenVdbSeesIt) {
  const std::string good = light_grid_bytes(small());
  EXPECT_EQ(error_of(foreign(good)), "");
  for (size_t n = 60; n < good.size(); n += 1009) {
    std::string bad = good;
    bad[n] = static_cast<char>(bad[n] ^ 1);
    EXPECT_EQ(error_of(bad), " is damaged or cut short") << n;
  }
}

// An attribute at index 2^56 crashes OpenVDB.
TEST(LightGridFormat, DamageOfForeignFilesEndsNoProgram) {
  std::string bad = foreign(light_grid_bytes(small()));
  const std::string_view attribute = "along";
  bad[bad.rfind(attribute) + attribute.size() + 7] = 1;
  EXPECT_EQ(error_of(bad), " is damaged or cut short");
}

// OpenVDB itself refuses voxels that small.
TEST(LightGridFormat, VoxelsOfAThousandthOfAMillimetre) {
  LightGrid g = small();
  constexpr double kScale = 1e-6;
  g.origin = g.origin * kScale, g.voxel *= kScale;
  for (LightLine& l : g.lines) l.light = l.light * kScale, l.camera = l.camera * kScale;
  for (Probe& p : g.probes)
    p.line.light = p.line.light * kScale, p.line.camera = p.line.camera * kScale;
  const LightGrid back = read(light_grid_bytes(g));
  EXPECT_EQ(back.voxel, g.voxel);
  EXPECT_EQ(back.count, g.count);
  expect_same_lines(back, g, 1e-6 * kScale);
}

// The lengths from the walk against a brute-force sum over small steps, each assigned to the voxel
// of its midpoint.
TEST(WalkGrid, PassesEveryVoxelOfTheSegment) {
  LightGrid g;
  g.origin = {-1, -2, -3};
  g.voxel = 0.5;
  g.dim = {4, 6, 8};
  const size_t n = 4 * 6 * 8;
  for (uint64_t trial = 0; trial < 200; ++trial) {
    Rng rng(1, 2, trial);
    const auto point = [&] {
      const double x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
      return Vec3d{-2 + 4 * x, -3 + 5 * y, -4 + 6 * z};
    };
    const Vec3d a = point();
    Vec3d b = point();
    if (trial % 4 == 0) b.x = a.x;
    if (trial % 8 == 0) b.y = a.y;
    std::vector<double> walked(n, 0), stepped(n, 0);
    walk_grid(g, a, b, [&](size_t i, double s) { walked.at(i) += s; });
    constexpr int kSteps = 4000;
    for (int s = 0; s < kSteps; ++s) {
      const Vec3d p = (a + (b - a) * ((s + 0.5) / kSteps) - g.origin) / g.voxel;
      const int i = static_cast<int>(std::floor(p.x)), j = static_cast<int>(std::floor(p.y)),
                k = static_cast<int>(std::floor(p.z));
      if (i < 0 || j < 0 || k < 0 || i >= 4 || j >= 6 || k >= 8) continue;
      stepped[g.index(i, j, k)] += length(b - a) / kSteps;
    }
    for (size_t i = 0; i < n; ++i) EXPECT_NEAR(walked[i], stepped[i], 2.1 * length(b - a) / kSteps);
  }
}

}  // namespace tdpt::light_grid_test
