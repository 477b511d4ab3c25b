// The light that a limit of depth leaves out, and its sentence.
#include "tools/tdpt-render/plan/truncation.h"

#include <numeric>

#include <gtest/gtest.h>

#include "tools/tdpt-render/plan/exploration.h"
#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::truncation_test {

// In the furnace of albedo 1/2 paths of up to k edges carry a share of 1 - 2^-k of the light.
Truncation in_the_furnace(int depth) {
  const Scene scene = read_gltf(furnace_path());
  Vista vista(scene, scene.camera(""), 16, 16, {});
  return explore(vista, scene.camera(""), {}, depth, 7).beyond.value();
}

TEST(truncation, share_of_the_furnace_is_known) {
  for (const int depth : {1, 3, 5}) {
    const Truncation beyond = in_the_furnace(depth);
    EXPECT_EQ(beyond.depth, depth);
    EXPECT_LT(beyond.error, 0.02);
    EXPECT_NEAR(beyond.share, std::pow(0.5, depth), 5 * beyond.error);
    // Twin: paths one edge longer are counted as within.
    EXPECT_GT(std::abs(beyond.share - std::pow(0.5, depth + 1)), 5 * beyond.error);
  }
}

TEST(truncation, is_told_with_as_many_digits_as_are_known) {
  EXPECT_EQ(sentence({6, 0.2512, 0.01}), "--max-depth 6 leaves out about 25 % of the light");
  EXPECT_EQ(sentence({12, 0.0363, 0.001}), "--max-depth 12 leaves out about 3.6 % of the light");
  EXPECT_EQ(sentence({6, 0.02, 0.01}), "--max-depth 6 leaves out at most about 4 % of the light");
  EXPECT_EQ(sentence({6, 0.0001, 0.0001}), "--max-depth 6 leaves out less than 0.1 % of the light");
  EXPECT_EQ(sentence({2, 1, 0}), "--max-depth 2 leaves out all of the light, or nearly");
}

RenderResult rendered(int max_depth, float albedo) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  const Vista vista(scene, scene.camera(""), 4, 4, {});
  Job settings;
  settings.limits.spp = albedo < 1 ? 64 : 1;
  settings.max_depth = max_depth;
  return render(vista, pt, settings);
}

TEST(length, of_paths_is_told_by_octaves) {
  const RenderResult r = rendered(kMaxDepth, 0.5f);
  EXPECT_EQ(length_sentence({}, r), "");
  const double all = std::accumulate(r.tally.by_length.begin(), r.tally.by_length.end(), 0.0);
  // 1, 2, 3 to 4, 5 to 8 edges.
  for (const auto& [octave, share] : {std::pair{0, 0.5}, {1, 0.25}, {2, 0.1875}, {3, 0.05859375}})
    EXPECT_NEAR(r.tally.by_length[static_cast<size_t>(octave)] / all, share, 0.02) << octave;
}

TEST(length, where_no_walk_ends_the_hard_stop_is_told) {
  EXPECT_EQ(length_sentence({}, rendered(kMaxDepth, 1)),
            "paths of 513 to 1024 edges hold 50 % of the light; what longer ones hold is left out");
}

}  // namespace tdpt::truncation_test
