#include "libcommon/formats/light_grid.h"

#include <cstring>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/math/rng.h"

namespace tdpt::light_grid_test {

class LightGridFormat : public ::testing::Test {
 protected:
  ~LightGridFormat() override { std::filesystem::remove(path_); }
  std::string write(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }
  std::string error_of(const std::string& bytes) const {
    try {
      read_light_grid(write(bytes));
    } catch (const InputError& e) {
      return std::string(e.what()).substr(path_.size() + 1);
    }
    return "no error";
  }
  std::string path_ =
      (std::filesystem::temp_directory_path() / ("light_grid_test." + std::to_string(::getpid())))
          .string();
};

LightGrid small() {
  LightGrid g;
  g.origin = {-1, 2, 100};
  g.voxel = 0.25;
  g.dim = {5, 4, 3};
  const size_t n = 60;
  g.count.assign(n, 0);
  g.air.assign(n, 1);
  g.direction.assign(n, {});
  g.count[g.index(4, 3, 2)] = 7;
  g.count[g.index(0, 1, 2)] = 3;
  g.air[g.index(1, 1, 1)] = 0;
  g.direction[g.index(4, 3, 2)] = {0.5f, -0.25f, 0.125f};
  g.lines = {{{-0.9, 2.1, 100.1}, {0.1, 2.9, 100.7}}, {{0, 2.5, 100.2}, {-0.5, 2.25, 100.3}}};
  g.probes = {{{{-0.9, 2.1, 100.1}, {0.1, 2.9, 100.7}, 1}, true},
              {{{0, 2.5, 100.2}, {-0.25, 2.25, 100.25}, 0}, false}};
  g.scene_hash = "abc";
  g.cameras = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  g.flux_share = 0.75;
  g.cuts = {{0.01, 0.5}, {0.25, 1}};
  g.walls = {{0, 1, 0}, {0.6, 0, -0.8}};
  g.panes = {{{0, 1.0 / 3, 0}, {0, 0.3, 0}}, {{1, 2, 3}, {1, 2, 3.01}}};
  g.provenance.lines = {"made by lightgrid 1: lightgrid", "from a b"};
  return g;
}

// In any order: OpenVDB sorts points by voxel.
void expect_same_lines(const LightGrid& back, const LightGrid& g, double within) {
  ASSERT_EQ(back.lines.size(), g.lines.size());
  for (const LightLine& line : g.lines) {
    double nearest = INFINITY;
    for (const LightLine& other : back.lines)
      nearest =
          std::min(nearest, length(line.light - other.light) + length(line.camera - other.camera));
    EXPECT_LT(nearest, within);
  }
}

TEST_F(LightGridFormat, ComesBackAsItWasWritten) {
  const LightGrid g = small();
  const std::string bytes = light_grid_bytes(g);
  const LightGrid back = read_light_grid(write(bytes));
  EXPECT_EQ(back.origin, g.origin);
  EXPECT_EQ(back.voxel, g.voxel);
  EXPECT_EQ(back.dim, g.dim);
  EXPECT_EQ(back.count, g.count);
  EXPECT_EQ(back.air, g.air);
  EXPECT_EQ(back.direction, g.direction);
  ASSERT_EQ(back.probes.size(), 2u);
  const size_t joining = back.probes[0].joins ? 0 : 1;
  EXPECT_TRUE(back.probes[joining].joins);
  EXPECT_EQ(back.probes[joining].line.cut, 1u);
  EXPECT_LT(length(back.probes[joining].line.camera - g.probes[0].line.camera), 1e-6);
  EXPECT_FALSE(back.probes[1 - joining].joins);
  EXPECT_EQ(back.scene_hash, "abc");
  EXPECT_EQ(back.cameras, g.cameras);
  EXPECT_EQ(back.flux_share, 0.75);
  ASSERT_EQ(back.cuts.size(), 2u);
  EXPECT_EQ(back.cuts[0].conductance, 0.01);
  EXPECT_EQ(back.cuts[0].kept, 0.5);
  EXPECT_EQ(back.cuts[1].conductance, 0.25);
  EXPECT_EQ(back.cuts[1].kept, 1);
  EXPECT_EQ(back.walls, g.walls);
  EXPECT_EQ(back.panes, g.panes);
  EXPECT_TRUE(back.bottleneck);
  EXPECT_EQ(back.provenance.lines, g.provenance.lines);
  expect_same_lines(back, g, 1e-6);
  EXPECT_TRUE(light_grid_bytes(g) == bytes) << "two writings differ";
}

TEST_F(LightGridFormat, KeepsTheCameraOfEachCut) {
  LightGrid g = small();
  g.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  g.cuts[1].camera = 1;
  const LightGrid back = read_light_grid(write(light_grid_bytes(g)));
  EXPECT_EQ(back.cameras, g.cameras);
  EXPECT_EQ(back.number_of_cameras(), 2u);
  EXPECT_EQ(back.cuts, g.cuts);
  EXPECT_EQ(back.camera_of(1), 1u);
  EXPECT_EQ(back.camera_of(7), 0u) << "unknown";
  expect_same_lines(back, g, 1e-6);
  g.cuts[1].camera = 2;
  EXPECT_EQ(
      error_of(light_grid_bytes(g)),
      "tdpt_light_grid:line 11: '3' as camera of the cut, expected a whole number from 1 to 2");
}

TEST_F(LightGridFormat, RefusesAShareThatNoLightHas) {
  LightGrid g = small();
  g.lines[0].share = 1e7;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "grid lines: holds a line with the share 10000000, expected 0 to 1000000");
}

// The same bits except for the order of lines; only viewers see another orientation.
TEST_F(LightGridFormat, StandsUprightOnDemandAndIsReadAsTheSame) {
  const LightGrid g = small();
  const std::string lying = light_grid_bytes(g), upright = light_grid_bytes(g, true);
  EXPECT_TRUE(lying.find("tdpt_z_up") == std::string::npos);
  ASSERT_TRUE(upright.find("tdpt_z_up") != std::string::npos);
  const LightGrid a = read_light_grid(write(lying)), b = read_light_grid(write(upright));
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.direction, b.direction);
  expect_same_lines(b, a, 1e-15);
  ASSERT_EQ(a.probes.size(), b.probes.size());
  for (size_t i = 0; i < a.probes.size(); ++i)
    EXPECT_EQ(a.probes[i].line.camera, b.probes[i].line.camera);
  // A reader that confuses the two finds lines outside their box.
  std::string taken = upright;
  taken.replace(taken.find("tdpt_z_up"), 9, "tdpt_x_up").replace(21 + 14, 1, "4");
  EXPECT_EQ(error_of(taken), "grid lines: reaches out of its box");
}

TEST_F(LightGridFormat, NoBottleneckIsAFileToo) {
  LightGrid g;
  g.bottleneck = false;
  g.reason = "one side is empty";
  const LightGrid back = read_light_grid(write(light_grid_bytes(g)));
  EXPECT_FALSE(back.bottleneck);
  EXPECT_EQ(back.reason, "one side is empty");
  EXPECT_TRUE(back.lines.empty());
  EXPECT_TRUE(back.count.empty());
}

TEST_F(LightGridFormat, RefusesWhatIsNoLightGrid) {
  EXPECT_NE(error_of("").find("is no light grid in OpenVDB format"), std::string::npos);
  EXPECT_NE(error_of("hello, this is text").find("is no light grid in OpenVDB format"),
            std::string::npos);
  LightGrid g = small();
  g.dim = {5, 5000, 1};
  g.count.clear(), g.air.clear(), g.direction.clear();
  g.count.resize(25000), g.air.resize(25000), g.direction.resize(25000);
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "tdpt_light_grid:line 6: '5000' as voxels along a side, expected a whole number from 0 "
            "to 2048");
  g = small();
  g.voxel = -1;
  EXPECT_EQ(
      error_of(light_grid_bytes(g)),
      "tdpt_light_grid:line 6: voxels of no size that single precision holds, expected a side "
      "above 0");
  g = small();
  g.count[0] = -1;
  EXPECT_EQ(error_of(light_grid_bytes(g)), "grid count: holds -1, expected a count");
  g = small();
  g.direction[0].x = INFINITY;
  EXPECT_EQ(error_of(light_grid_bytes(g)), "grid direction: holds a value that is not finite");
  g = small();
  g.lines[0].camera = g.lines[0].light;
  EXPECT_EQ(error_of(light_grid_bytes(g)), "grid lines: holds a line that is no segment");
  g = small();
  g.probes[0].line.cut = 64;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "grid probes: holds a line of cut 64, expected one of 0 to 63");
  g = small();
  g.cuts.assign(65, {});
  EXPECT_EQ(error_of(light_grid_bytes(g)), "tdpt_light_grid:line 73: one cut more than 64");
  g = small();
  g.cuts[1].conductance = 1.5;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "tdpt_light_grid:line 10: 1.5 as share, expected 0 to 1");
  g = small();
  g.cuts[0].kept = NAN;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "tdpt_light_grid:line 9: 'nan' as share, expected a finite number");
  g = small();
  g.walls[0].y = 2;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "tdpt_light_grid:line 11: a wall that is 2 long, expected a unit vector");
  g.walls.assign(17, {1, 0, 0});
  EXPECT_EQ(error_of(light_grid_bytes(g)), "tdpt_light_grid:line 27: one wall more than 16");
  g = small();
  g.panes[1].back = g.panes[1].front;
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            "tdpt_light_grid:line 14: a pane without thickness, expected two places apart from "
            "each other");
  g.panes.assign(65, {{1, 0, 0}, {1, 0, 1}});
  EXPECT_EQ(error_of(light_grid_bytes(g)), "tdpt_light_grid:line 77: one pane more than 64");
  g = small();
  g.cameras = {"1 2 3"};
  EXPECT_EQ(error_of(light_grid_bytes(g)),
            std::string("tdpt_light_grid:line 5: '1 2 3' as camera, ") + kViewpointExpected);
  g = small();
  g.lines[0].camera.y = 1e30;
  EXPECT_EQ(error_of(light_grid_bytes(g)), "grid lines: reaches out of its box");
}

// A file of another program: its identifier is not a hash of its bytes.
std::string foreign(std::string bytes) {
  return bytes.replace(21 + 14, 1, "4");
}

TEST_F(LightGridFormat, RefusesAnotherVersion) {
  std::string bytes = foreign(light_grid_bytes(small()));
  const std::string first = "# tdpt light grid ";
  ++bytes[bytes.find(first) + first.size()];
  EXPECT_EQ(error_of(bytes),
            "tdpt_light_grid:line 1: this file has version 2 of the format; this program reads "
            "version 1");
  EXPECT_EQ(error_of(bytes.replace(bytes.find("tdpt_light_grid"), 4, "tdpT")),
            "tdpt_light_grid: is missing, expected a light grid as lightgrid writes it");
}

// As a program without points saves it, in a file of its own.
TEST_F(LightGridFormat, IsRefusedWithoutOneOfItsGrids) {
  for (const std::string grid : {"lines", "direction"}) {
    std::string bytes = foreign(light_grid_bytes(small()));
    const size_t at = bytes.find(grid);
    ASSERT_NE(at, bytes.npos);
    for (size_t next = at; next != bytes.npos; next = bytes.find(grid, next)) bytes[next] = 'x';
    EXPECT_EQ(error_of(bytes),
              " has no grid " + grid +
                  ", expected count, air, direction and lines: did another program save it again?");
  }
  LightGrid none = small();
  none.lines.clear(), none.probes.clear();
  EXPECT_EQ(error_of(light_grid_bytes(none)), "no error") << "there may be no line";
}

TEST_F(LightGridFormat, RefusesLinesWithoutVoxels) {
  LightGrid g = small();
  g.dim = {0, 0, 0};
  g.count.clear(), g.air.clear(), g.direction.clear();
  EXPECT_EQ(error_of(light_grid_bytes(g)), "grid lines: reaches out of its box");
}

// `bytes` of a file of one voxel with other numbers of them.
std::string of_voxels(std::string bytes, const std::string& side) {
  const std::string one = " 0.25 1 1 1\n";
  const size_t at = bytes.find(one);
  const std::string header = " 0.25 " + side + " " + side + " " + side + "\n";
  // The header is preceded by its length.
  const size_t length_at = bytes.find("# tdpt light grid") - sizeof(int32_t);
  int32_t length = 0;
  std::memcpy(&length, &bytes[length_at], sizeof length);
  length += static_cast<int32_t>(header.size() - one.size());
  std::memcpy(&bytes[length_at], &length, sizeof length);
  return bytes.replace(at, one.size(), header);
}

TEST_F(LightGridFormat, OneVoxelAndTooManyOfThem) {
  LightGrid g = small();
  g.dim = {1, 1, 1};
  g.count = {3}, g.air = {1}, g.direction = {{1, 0, 0}};
  g.lines = {{{-1, 2, 100}, {-0.75, 2.25, 100.25}, 0}}, g.probes.clear();
  const LightGrid back = read_light_grid(write(light_grid_bytes(g)));
  EXPECT_EQ(back.count, g.count);
  expect_same_lines(back, g, 1e-6);
  EXPECT_EQ(error_of(foreign(of_voxels(light_grid_bytes(g), "1024"))),
            "tdpt_light_grid:line 6: 1073741824 voxels, expected at most 134217728");
  EXPECT_EQ(error_of(foreign(of_voxels(light_grid_bytes(g), "512"))),
            "tdpt_light_grid: 134217728 voxels, but 1 hold air or light, expected one in 1024");
}

TEST_F(LightGridFormat, TakesNoMoreThanTheLimitOfMemory) {
  LightGrid g = small();
  g.dim = {64, 64, 64};
  const size_t n = size_t{64} * 64 * 64;
  g.count.assign(n, 1), g.air.assign(n, 1), g.direction.assign(n, {1, 0, 0});
  const std::string bytes = light_grid_bytes(g);
  const uint64_t machine = memory_limit();
  limit_memory(1 << 20);
  EXPECT_EQ(error_of(bytes),
            "tdpt_light_grid: 262144 voxels take 4.25 MiB of memory, expected at most the 1 MiB of "
            "--max-memory");
  limit_memory(machine);
  EXPECT_EQ(error_of(bytes), "no error");
}

// A grid of 128 voxels a side with different values, made in a child process, so that its memory
// does not count here.
std::string bytes_of_many_leaves() {
  const auto make = [](std::FILE* out) {
    LightGrid g = small();
    g.dim = {128, 128, 128};
    const size_t n = size_t{128} * 128 * 128;
    g.count.assign(n, 1), g.air.assign(n, 1), g.direction.assign(n, {1, 0, 0});
    for (size_t i = 0; i < n; i += 2) g.count[i] = 2, g.direction[i] = {0, 1, 0};
    const std::string bytes = light_grid_bytes(g);
    std::fwrite(bytes.data(), 1, bytes.size(), out);
  };
  std::string bytes;
  in_another_process(make, [&](std::FILE* in) {
    for (int c; (c = std::fgetc(in)) != EOF;) bytes += static_cast<char>(c);
    return true;
  });
  return bytes;
}

// OpenVDB's own trees are bounded when they are read.
TEST_F(LightGridFormat, TreesTakeNoMoreEither) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "where memory is short, the sanitizer ends the process";
#endif
  const std::string bytes = bytes_of_many_leaves();
  const uint64_t machine = memory_limit();
  limit_memory(36 << 20);
  EXPECT_EQ(error_of(bytes),
            " takes more memory than there is, or than the 36 MiB of --max-memory");
  limit_memory(machine);
  EXPECT_EQ(error_of(bytes), "no error");
}

// Points with equal values take no space in the file.
TEST_F(LightGridFormat, LinesTakeRoomInTheFile) {
  LightGrid g = small();
  g.lines.assign(150'000, g.lines[0]);
  const std::string bytes = light_grid_bytes(g);
  ASSERT_LT(bytes.size(), 80'000u);
  EXPECT_EQ(error_of(bytes), fmt::format("grid lines: 150000 lines, expected at most {} in a file "
                                         "of this size",
                                         65536 + bytes.size()));
}

TEST_F(LightGridFormat, GridsStandOnce) {
  std::string twice = foreign(light_grid_bytes(small()));
  const std::string lines = "lines";
  for (size_t at = 0; (at = twice.find(lines, at)) != twice.npos; at += lines.size())
    twice.replace(at, lines.size(), "count");
  EXPECT_EQ(error_of(twice), "grid count: again, expected each once");
}

TEST_F(LightGridFormat, DamageShowsBeforeOpenVdbSeesIt) {
  const std::string good = light_grid_bytes(small());
  EXPECT_EQ(error_of(foreign(good)), "no error");
  for (size_t n = 60; n < good.size(); n += 101) {
    std::string bad = good;
    bad[n] = static_cast<char>(bad[n] ^ 1);
    EXPECT_EQ(error_of(bad), " is damaged or cut short") << n;
  }
}

// An attribute at index 2^56 crashes OpenVDB.
TEST_F(LightGridFormat, DamageOfForeignFilesEndsNoProgram) {
  std::string bad = foreign(light_grid_bytes(small()));
  const std::string_view attribute = "along";
  bad[bad.rfind(attribute) + attribute.size() + 7] = 1;
  EXPECT_EQ(error_of(bad), " is damaged or cut short");
}

// OpenVDB itself refuses voxels that small.
TEST_F(LightGridFormat, VoxelsOfAThousandthOfAMillimetre) {
  LightGrid g = small();
  constexpr double kScale = 1e-6;
  g.origin = g.origin * kScale, g.voxel *= kScale;
  for (LightLine& l : g.lines) l.light = l.light * kScale, l.camera = l.camera * kScale;
  for (Probe& p : g.probes)
    p.line.light = p.line.light * kScale, p.line.camera = p.line.camera * kScale;
  const LightGrid back = read_light_grid(write(light_grid_bytes(g)));
  EXPECT_EQ(back.voxel, g.voxel);
  EXPECT_EQ(back.count, g.count);
  expect_same_lines(back, g, 1e-6 * kScale);
}

TEST_F(LightGridFormat, CutsNeedNotBeKnown) {
  LightGrid g = small();
  g.cuts.clear();
  EXPECT_TRUE(read_light_grid(write(light_grid_bytes(g))).cuts.empty());
}

TEST_F(LightGridFormat, SurvivesBeingCutShort) {
  const std::string good = light_grid_bytes(small());
  for (size_t n = 0; n + 1 < good.size(); n += 131) {
    EXPECT_NE(error_of(good.substr(0, n)), "no error") << n;
    if (n > 60) {
      EXPECT_NE(error_of(foreign(good).substr(0, n)), "no error") << n;
    }
  }
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

TEST(WalkGrid, CrossesASmallGridByHand) {
  LightGrid g;
  g.dim = {3, 2, 1};
  std::vector<size_t> seen;
  walk_grid(g, {-1, 0.5, 0.5}, {4, 0.5, 0.5}, [&](size_t i, double) { seen.push_back(i); });
  EXPECT_EQ(seen, (std::vector<size_t>{0, 1, 2}));
  seen.clear();
  walk_grid(g, {2.5, 1.75, 0.5}, {0.5, 0.25, 0.5}, [&](size_t i, double) { seen.push_back(i); });
  EXPECT_EQ(seen, (std::vector<size_t>{5, 4, 1, 0}));
  seen.clear();
  walk_grid(g, {0, 5, 0}, {3, 5, 0}, [&](size_t i, double) { seen.push_back(i); });
  EXPECT_TRUE(seen.empty());
}

}  // namespace tdpt::light_grid_test
