#include "libcommon/cli/completion.h"

#include <gtest/gtest.h>

namespace tdpt::cli::completion_test {

using Words = std::vector<std::string>;

TEST(completion, words_of_a_value_are_those_in_small_letters) {
  EXPECT_EQ(words_of("draft|normal|high"), (Words{"draft", "normal", "high"}));
  EXPECT_EQ(words_of("cpu|gpu[:WHICH]"), (Words{"cpu", "gpu"}));
  EXPECT_EQ(words_of("FILE|auto"), (Words{"auto"}));
  EXPECT_EQ(words_of("FILE|R,G,B"), Words{});
  EXPECT_EQ(words_of("N"), Words{});
  EXPECT_EQ(words_of(""), Words{});
}

TEST(completion, suffixes_are_those_that_the_help_names) {
  EXPECT_EQ(suffixes_in("Scene (.glb, .gltf); - is standard input"), (Words{".glb", ".gltf"}));
  EXPECT_EQ(suffixes_in("The scene, glTF 2.0 (.glb or .gltf)"), (Words{".glb", ".gltf"}));
  EXPECT_EQ(suffixes_in("Any file. Whatever it is. "), Words{});
}

TEST(completion, quotes_of_a_help_text_do_not_end_those_of_the_script) {
  const std::vector<Completed> table{
      {{"--camera", "-c"}, "Whose 'eye' [it is]", "NAME", {}, false, {}, false}};
  EXPECT_NE(completion_script("zsh", "tool", table)
                .find(R"('(--camera -c)--camera=[Whose '\''eye'\'' \[it is\]]:NAME: ')"),
            std::string::npos);
  EXPECT_NE(completion_script("fish", "tool", table)
                .find(R"(complete -c tool -l camera -s c -x -d 'Whose \'eye\' [it is]')"),
            std::string::npos);
  EXPECT_NE(completion_script("bash", "tool", table).find("  --camera | -c) return ;;\n"),
            std::string::npos);
}

}  // namespace tdpt::cli::completion_test
