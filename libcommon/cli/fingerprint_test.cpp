#include <gtest/gtest.h>

#include "libcommon/cli/cli.h"

namespace tdpt::cli::fingerprint_test {

constexpr Program kProgram{"made-up", "Has an option of each effect.", "What there is"};

// What is common to programs, as these words set it.
Common common_of(std::vector<std::string> words) {
  std::string input, sky, picture, samples, stored, speed, said;
  bool flag = false;
  Options options(kProgram);
  options.input("--input", input, "FILE", "A file");
  options.input_or_setting("--sky", sky, "FILE|none", "A file or none",
                           [](const std::string& value) { return value != "none"; });
  options.option("--picture", picture, "WORD", "Unclassified");
  options.flag("--flag", flag, "Unclassified, too");
  options.part(Part::light);
  options.option("--set samples", samples, "WORD", "How many", Effect::samples);
  options.option("--stored", stored, "WORD", "How stored", Effect::stored);
  options.option("--speed", speed, "WORD", "How fast", Effect::speed);
  options.option("--report", said, "WORD", "What is said", Effect::report);
  words.insert(words.begin(), "made-up");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  Common common;
  EXPECT_EQ(options.run_main(static_cast<int>(argv.size()), argv.data(),
                             [&] { return common = options.common, 0; }),
            0);
  return common;
}

TEST(fingerprint, has_the_options_up_to_an_effect) {
  const Fingerprint facts{{"scene", "1f3a"}};
  const Common none = common_of({});
  const auto changed = [&](const std::vector<std::string>& words) {
    std::string effects;
    for (const Effect up_to :
         {Effect::picture, Effect::samples, Effect::stored, Effect::speed, Effect::report})
      effects += hash_of(common_of(words).fingerprint(facts, up_to)) ==
                         hash_of(none.fingerprint(facts, up_to))
                     ? '-'
                     : 'x';
    return effects;
  };
  EXPECT_EQ(changed({"--picture", "a"}), "xxxxx");
  EXPECT_EQ(changed({"--flag"}), "xxxxx");
  EXPECT_EQ(changed({"--seed", "2"}), "xxxxx");
  EXPECT_EQ(changed({"--set", "samples=a"}), "-xxxx");
  EXPECT_EQ(changed({"--stored", "a"}), "--xxx");
  EXPECT_EQ(changed({"--no-provenance"}), "--xxx");
  EXPECT_EQ(changed({"--speed", "a"}), "---xx");
  EXPECT_EQ(changed({"--threads", "1"}), "---xx");
  EXPECT_EQ(changed({"--report", "a"}), "----x");
  EXPECT_EQ(changed({"-o", "a"}), "----x");
  EXPECT_EQ(changed({"--sky", "none"}), "xxxxx");
  EXPECT_EQ(changed({"--sky", "a.hdr"}), "-----");  // its content is a fact
  EXPECT_EQ(changed({"--input", "a.glb"}), "-----");
  EXPECT_NE(hash_of(none.fingerprint(facts, Effect::report)),
            hash_of(none.fingerprint({{"scene", "77ab"}}, Effect::report)));
}

TEST(fingerprint, tells_the_first_difference) {
  const auto of = [](const std::vector<std::string>& words) {
    return common_of(words).fingerprint({{"scene", "1f3a"}}, Effect::picture);
  };
  EXPECT_EQ(difference(of({"--picture", "a"}), of({"--picture", "a"})), "");
  EXPECT_EQ(difference(of({"--picture", "a"}), of({"--picture", "b"})),
            "another --picture (a, expected b)");
  EXPECT_EQ(difference(of({"--flag"}), of({})), "another --flag (given, expected none)");
}

TEST(fingerprint, provenance_names_what_changes_the_samples) {
  Common common = common_of({"--stored", "a", "--set", "samples=a", "--input", "x.glb", "--sky",
                             "y.hdr", "--picture", "b/c", "--report", "d"});
  EXPECT_EQ(common.command, "made-up --picture c --set samples=a");
  ASSERT_EQ(common.given.size(), 6u);
  EXPECT_EQ(common.given[3].name, "--set samples");
  EXPECT_EQ(common.given[3].part, Part::light);
  common.give("--picture", {"e"});
  EXPECT_EQ(common.command, "made-up --picture e --set samples=a");
}

}  // namespace tdpt::cli::fingerprint_test
