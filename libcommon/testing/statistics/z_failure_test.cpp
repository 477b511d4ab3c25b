#include "libcommon/testing/statistics/z_failure.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include "libcommon/formats/picture.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/failures_elsewhere.h"
#include "libcommon/testing/files/read_png.h"

namespace tdpt::testing::z_failure_test {

class z_failure : public ::testing::Test {
 protected:
  static std::string bytes_of(const std::filesystem::path& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
  }

  const FailuresElsewhere elsewhere_;
};

/// 8 x 6 blocks with mean 1 and 1 % noise; block 10 has 1 + bias, block 45 1 - bias.
BlockRuns runs_of(uint64_t seed, double bias) {
  BlockRuns runs;
  for (uint64_t r = 0; r < 16; ++r) {
    Rng rng(seed, 0, r);
    std::vector<double> blocks(48);
    for (double& b : blocks) b = 1 + 0.035 * (rng.uniform() - 0.5);
    blocks[10] += bias;
    blocks[45] -= bias;
    runs.add(blocks);
  }
  return runs;
}

TEST_F(z_failure, a_disagreement_leaves_its_pictures_z_map_and_p_values) {
  const BlockRuns first = runs_of(1, 0.1), second = runs_of(2, 0);
  const Agreement agreement = compare(first, second);
  ASSERT_FALSE(agreement.holds());
  const ::testing::AssertionResult result = holds(agreement, "depth 3, a/b", first, second, 8);
  EXPECT_FALSE(result);
  const std::filesystem::path begin =
      elsewhere_.folder() / "z_failure.a_disagreement_leaves_its_pictures_z_map_and_p_values" /
      "depth_3__a_b";
  EXPECT_NE(std::string(result.message()).find(begin.string()), std::string::npos)
      << result.message();
  EXPECT_NE(std::string(result.message()).find(agreement.text()), std::string::npos);

  const Picture left = read_exr(begin.string() + ".first.exr").picture;
  EXPECT_EQ(left.width, 8);
  EXPECT_EQ(left.height, 6);
  EXPECT_NEAR(left.pixels[10].x, 1.1, 0.02);
  EXPECT_NEAR(read_exr(begin.string() + ".second.exr").picture.pixels[10].x, 1, 0.02);

  const PngPixels map = read_png(bytes_of(begin.string() + ".z.png"));
  ASSERT_EQ(map.width, 8 * 24);
  ASSERT_EQ(map.height, 6 * 24);
  const auto block = [&](int b) { return map.at(b % 8 * 24 + 12, b / 8 * 24 + 12); };
  EXPECT_EQ(block(10), (std::array<uint8_t, 3>{255, 0, 0}));
  EXPECT_EQ(block(45), (std::array<uint8_t, 3>{0, 0, 255}));
  int bright = 0;
  for (int b = 0; b < 48; ++b) bright += block(b)[1] > 100;
  EXPECT_GT(bright, 40);

  const std::string text = bytes_of(begin.string() + ".txt");
  EXPECT_EQ(text.find(agreement.text()), 0u);
  EXPECT_NE(text.find("(p "), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3 + 6);
}

TEST_F(z_failure, pairs_leave_theirs_too) {
  const BlockRuns first = runs_of(1, 0);
  BlockRuns second;
  for (size_t r = 0; r < first.runs(); ++r) {
    std::vector<double> blocks = first.run(r);
    Rng rng(3, 0, r);
    for (double& b : blocks) b *= 0.998 + 1e-5 * rng.uniform();
    second.add(blocks);
  }
  const Agreement agreement = compare_paired(first, second);
  EXPECT_FALSE(holds(agreement, "pairs", first, second, 8));
  const PngPixels map = read_png(bytes_of(failures_folder() / "pairs.z.png"));
  ASSERT_EQ(map.width, 8 * 24);
  for (const auto& pixel : map.rgb) EXPECT_EQ(pixel, (std::array<uint8_t, 3>{255, 0, 0}));
}

TEST_F(z_failure, blocks_that_were_not_asked_are_grey) {
  BlockRuns first = runs_of(1, 0.1), second;
  for (size_t r = 0; r < 16; ++r) {
    std::vector<double> blocks = runs_of(2, 0).run(r);
    blocks[20] = r == 0 ? 5 : 0;
    second.add(blocks);
  }
  EXPECT_FALSE(holds(compare(first, second), "scattered", first, second, 8));
  const PngPixels map = read_png(bytes_of(failures_folder() / "scattered.z.png"));
  ASSERT_EQ(map.width, 8 * 24);
  EXPECT_EQ(map.at(4 * 24, 2 * 24), (std::array<uint8_t, 3>{128, 128, 128}));
}

TEST_F(z_failure, an_agreement_leaves_nothing) {
  const BlockRuns first = runs_of(1, 0), second = runs_of(2, 0);
  EXPECT_TRUE(holds(compare(first, second), "same", first, second, 8));
  EXPECT_FALSE(std::filesystem::exists(elsewhere_.folder()));
}

}  // namespace tdpt::testing::z_failure_test
