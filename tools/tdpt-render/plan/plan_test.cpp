#include "tools/tdpt-render/plan/plan.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::plan_test {

TEST(plan, is_read_as_it_was_written) {
  Plan plan{tdpt_guided, "tdpt-guided", 1000, {{1, PortalWay::back}}, {}, {}};
  EXPECT_EQ(read_plan(plan_text(plan), "a"), plan);
  plan.integrator.mixture.connected = 2.625;
  plan.integrator.mixture.connected_to_segments = 1.7;
  plan.integrator.mixture.segments_connected = 16;
  EXPECT_EQ(read_plan(plan_text(plan), "a"), plan);
  Plan other = plan;
  other.integrator.mixture.connected = 2;
  EXPECT_FALSE(read_plan(plan_text(other), "a") == plan);
  other = plan;
  other.integrator.mixture.segments = 0.5;
  EXPECT_FALSE(read_plan(plan_text(other), "a") == plan);
  other = plan;
  other.integrator.mixture.segments_connected = 8;
  EXPECT_FALSE(read_plan(plan_text(other), "a") == plan);
  other = plan;
  other.integrator.mixture.light_walks = 0.5;
  EXPECT_FALSE(read_plan(plan_text(other), "a") == plan);
  EXPECT_EQ(read_plan(plan_text(other), "a"), other);
  EXPECT_FALSE(read_plan(plan_text(plan), "a").beyond);
  plan.beyond = {6, 0.25, 0.125};
  const auto beyond = read_plan(plan_text(plan), "a").beyond;
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->depth, 6);
  EXPECT_EQ(beyond->share, 0.25);
  EXPECT_EQ(beyond->error, 0.125);
}

TEST(plan, that_is_none_is_refused_with_its_place) {
  const auto message = [](std::string text, const std::string& from, const std::string& to) {
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    try {
      read_plan(text, "p.json");
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("read");
  };
  const std::string good = plan_text({});
  EXPECT_EQ(message("{", "", ""), "p.json: is no JSON object, expected a plan");
  EXPECT_EQ(message(good, "\"spp\"", "\"sp\""), "p.json:spp: is missing");
  EXPECT_EQ(message(good, "\"spp\":0", "\"spp\":-1"), "p.json:spp: is no such number");
  EXPECT_EQ(message(good, "\"segments\":1.0", "\"segments\":2"),
            "p.json:segments: is out of range");
  EXPECT_EQ(message(good, "\"light_walks\":1.0", "\"light_walks\":0.01"),
            "p.json:light_walks: is out of range");
  EXPECT_EQ(message(good, "\"portals\":[]", "\"portals\":[{\"portal\":0,\"way\":\"up\"}]"),
            "p.json:way: is not known");
  EXPECT_EQ(message(good, "\"portals\":[]", "\"portals\":[3]"),
            "p.json:portals: has an entry that is no object");
  EXPECT_EQ(message(good, "\"integrator\":\"bdpt\"", "\"integrator\":\"b\""),
            "p.json:integrator: is not known");
  EXPECT_EQ(message(good, "\"spp\":0", "\"spp\":0,\"beyond\":1"), "p.json:beyond: is no object");
  EXPECT_EQ(
      message(good, "\"spp\":0", "\"spp\":0,\"beyond\":{\"depth\":6,\"share\":2,\"error\":0}"),
      "p.json:share: is out of range");
  EXPECT_EQ(message(good, "", ""), "read");
}

TEST(plan, file_of_another_version_is_refused) {
  const testing::TempFolder folder;
  const auto message = [&](const std::string& from, const std::string& to) {
    std::string text = plan_file_text({{}, {{"scene", "77ab"}}, "tdpt-render"});
    text.replace(text.find(from), from.size(), to);
    const std::string path = folder.write("a.plan", text);
    try {
      read_plan_file(path);
    } catch (const InputError& e) {
      return std::string(e.what()).substr(path.size() + 1);
    }
    return std::string("read");
  };
  EXPECT_EQ(message("", ""), "read");
  EXPECT_EQ(message("\"format\": 1", "\"format\": 2"),
            "format: this file has version 2 of the format; this program reads version 1");
  EXPECT_EQ(message("\"format\"", "\"formal\""),
            "format: the file says no version of its format; this program reads version 1");
}

}  // namespace tdpt::plan_test
