#include "libcommon/cli/told.h"

#include <gtest/gtest.h>
#include <cstdlib>

#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::cli::told_test {

class told : public ::testing::Test {
 protected:
  ~told() override { unsetenv("TDPT_TOLD"); }
  void tell_in(const std::string& path) { setenv("TDPT_TOLD", path.c_str(), 1); }
  const testing::TempFolder folder_;
};

TEST_F(told, everything_is_news_to_a_program_alone) {
  EXPECT_TRUE(is_news("room.glb", "it is dark"));
  EXPECT_TRUE(is_news("room.glb", "it is dark"));
}

TEST_F(told, in_a_chain_each_thing_is_news_once) {
  tell_in((folder_.path / "told").string());
  EXPECT_TRUE(is_news("room.glb", "it is dark"));
  EXPECT_FALSE(is_news("room.glb", "it is dark"));
  EXPECT_TRUE(is_news("room.glb", "it is"));
  EXPECT_TRUE(is_news("room.glb", "is dark"));
  EXPECT_TRUE(is_news("hall.glb", "it is dark"));
  EXPECT_TRUE(is_news("hall.glb", "of\ntwo lines"));
  EXPECT_FALSE(is_news("hall.glb", "of\ntwo lines"));
}

TEST_F(told, a_file_that_cannot_be_used_hides_nothing) {
  const std::string pipe = (folder_.path / "pipe").string();
  ASSERT_EQ(std::system(("mkfifo '" + pipe + "'").c_str()), 0);
  for (const std::string& path : {std::string(), (folder_.path / "none" / "told").string(),
                                  folder_.path.string(), std::string("/dev/full"), pipe}) {
    tell_in(path);
    EXPECT_TRUE(is_news("room.glb", "it is dark")) << path;
    EXPECT_TRUE(is_news("room.glb", "it is dark")) << path;
  }
}

}  // namespace tdpt::cli::told_test
