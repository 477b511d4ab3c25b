#include "tools/tdpt-render/plan/shot_plan.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"

namespace tdpt::testing::shot_plan_test {
namespace {

KeyFrame key(int64_t frame, const std::vector<std::pair<std::string, double>>& costs) {
  KeyFrame k{frame, {}};
  for (const auto& [label, cost] : costs) {
    Plan plan;
    plan.label = label;
    plan.spp = static_cast<uint64_t>(frame);  // to tell the keys apart
    k.offers.push_back({plan, cost});
  }
  return k;
}

std::string labels(const std::vector<KeyFrame>& keys) {
  std::string text;
  for (const auto& [frame, plan] : even_plans(keys)) {
    EXPECT_EQ(plan.spp, static_cast<uint64_t>(frame));
    text += plan.label + " ";
  }
  return text;
}

TEST(ShotPlan, IsOneWhereTwoAreNearlyAsGood) {
  EXPECT_EQ(labels({key(1, {{"a", 1}, {"b", 1.05}}), key(9, {{"a", 1.05}, {"b", 1}}),
                    key(17, {{"a", 1}, {"b", 1.2}})}),
            "a a a ");
  // Of two that reach as far, the cheaper.
  EXPECT_EQ(labels({key(1, {{"a", 1}, {"b", 1.02}}), key(9, {{"a", 1.08}, {"b", 1}})}), "b b ");
}

TEST(ShotPlan, ChangesWhereThatIsALoss) {
  EXPECT_EQ(labels({key(1, {{"a", 1}, {"b", 1.09}}), key(9, {{"a", 1}, {"b", 1.09}}),
                    key(17, {{"a", 1.5}, {"b", 1}}), key(25, {{"a", 9}, {"b", 1}})}),
            "b b b b ");
  EXPECT_EQ(labels({key(1, {{"a", 1}, {"b", 1.11}}), key(9, {{"a", 1}, {"b", 1.09}}),
                    key(17, {{"a", 1.5}, {"b", 1}})}),
            "a a b ");
}

TEST(ShotPlan, FindsWhereItChanges) {
  const std::vector<std::pair<std::string, double>> a{{"a", 1}, {"b", 2}}, b{{"a", 2}, {"b", 1}};
  std::vector<KeyFrame> keys{key(1, a), key(13, a), key(25, b), key(37, b)};
  std::vector<int64_t> asked;
  while (const auto frame = next_key(keys)) {
    asked.push_back(*frame);
    ASSERT_LT(asked.size(), 9u);
    const auto after =
        std::find_if(keys.begin(), keys.end(), [&](const KeyFrame& k) { return k.frame > *frame; });
    keys.insert(after, key(*frame, *frame < 18 ? a : b));
  }
  EXPECT_EQ(asked, (std::vector<int64_t>{19, 16}));  // between 16 and 19
  EXPECT_EQ(next_key({key(1, a), key(40, a)}), std::nullopt);
}

TEST(ShotPlan, TakesWhatOnlyOneKeyOffers) {
  EXPECT_EQ(labels({key(1, {{"a", 1}}), key(9, {{"", 1}}), key(17, {{"b", 0}, {"a", 0}})}),
            "a  b ");
}

TEST(ShotPlan, IsToldByFrames) {
  PlanFile shot;
  shot.frames = even_plans({key(1, {{"a", 1}}), key(9, {{"b", 1}}), key(17, {{"b", 1}})});
  EXPECT_EQ(plan_sentence(shot, 1, 17),
            "the plan changes within the shot: frames 1-5 by a, 6-17 by b");
  EXPECT_EQ(plan_sentence(shot, 6, 17), "one plan for the shot: b");
}

TEST(ShotPlan, ComesBackFromItsFile) {
  PlanFile shot;
  shot.shape = {{"scene", "77ab"}};
  shot.command = "tdpt-render --frames 1-17";
  Plan plan;
  plan.lights.surfaces = 1;
  plan.integrator.stream = 2;
  for (const char* label : {"a", "b"}) {
    plan.label = label;
    shot.frames[label == std::string("a") ? 1 : 9] = plan;
  }
  const std::string path = ::testing::TempDir() + "/shot_plan_test.plan";
  write_output(path, plan_file_text(shot));
  const PlanFile back = read_plan_file(path);
  ASSERT_EQ(back.frames.size(), 2u);
  EXPECT_EQ(back.frames.at(9), shot.frames.at(9));
  EXPECT_EQ(back.of_frame(4).label, "a");
  EXPECT_EQ(back.shape, shot.shape);
}

TEST(ShotPlan, ThatIsMalformedIsRefused) {
  const std::string path = ::testing::TempDir() + "/shot_plan_test.plan";
  for (const char* frames : {"[]", "7", R"([{"frame": 1}])", R"([{"frame": -1, "plan": {}}])",
                             R"([{"frame": "a", "plan": {}}])", R"([{"plan": {}}])",
                             R"([{"frame": 9223372036854775813, "plan": {}}])"}) {
    write_output(path, fmt::format(R"({{"format": 1, "frames": {}, "shape": {{}}, "command": ""}})",
                                   frames));
    try {
      read_plan_file(path);
      ADD_FAILURE() << frames;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("frames: "), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace tdpt::testing::shot_plan_test
