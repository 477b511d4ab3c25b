#include "libcommon/cli/nearest.h"

#include <gtest/gtest.h>

namespace tdpt::cli::nearest_test {

const std::vector<std::string> kNames{"spp",   "time",   "max-depth", "max-portals", "width",
                                      "light", "height", "camera",    "environment"};

TEST(nearest, is_the_word_with_the_fewest_slips) {
  EXPECT_EQ(nearest("max-dept", kNames), "max-depth");      // deletion
  EXPECT_EQ(nearest("maxx-depth", kNames), "max-depth");    // insertion
  EXPECT_EQ(nearest("max_depth", kNames), "max-depth");     // substitution
  EXPECT_EQ(nearest("wdith", kNames), "width");             // transposition
  EXPECT_EQ(nearest("hieght", kNames), "height");           // nearer than "light"
  EXPECT_EQ(nearest("Spp", kNames), "spp");                 // case is ignored
  EXPECT_EQ(nearest("envrionmet", kNames), "environment");  // two edits
  EXPECT_EQ(nearest("pt", {"pt"}), "pt");
}

TEST(nearest, is_none_where_all_are_far) {
  EXPECT_EQ(nearest("magic", kNames), "");
  EXPECT_EQ(nearest("file", kNames), "");  // two edits from "time" are too many
  EXPECT_EQ(nearest("", kNames), "");
  EXPECT_EQ(nearest("x", {"y"}), "");
  EXPECT_EQ(nearest("ab", {"cd"}), "");
  EXPECT_EQ(nearest("seed", {}), "");
  EXPECT_EQ(nearest(std::string(1 << 20, 'a'), kNames), "");
}

TEST(nearest, is_the_only_word_that_begins_so) {
  EXPECT_EQ(nearest("env", kNames), "environment");
  EXPECT_EQ(nearest("cam", kNames), "camera");
  EXPECT_EQ(nearest("max", kNames), "");  // two begin so
  EXPECT_EQ(nearest("en", kNames), "");   // too short
}

TEST(option_meant, is_ours_for_a_word_of_other_renderers_where_the_program_has_it) {
  EXPECT_EQ(option_meant("samples", {"seed", "spp"}), "spp");
  EXPECT_EQ(option_meant("samples", {"seed", "sample"}), "sample");  // the nearest
  EXPECT_EQ(option_meant("Sky", {"seed", "environment"}), "environment");
  EXPECT_EQ(option_meant("bounces", {"max-depth", "quality"}), "max-depth");
  EXPECT_EQ(option_meant("", {"spp", "width"}), "");
  EXPECT_EQ(option_meant("image samples", {"spp", "output"}), "") << "two words are none of them";
}

}  // namespace tdpt::cli::nearest_test
