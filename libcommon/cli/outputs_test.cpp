#include "libcommon/cli/outputs.h"

#include <chrono>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::cli::outputs_test {
namespace fs = std::filesystem;

using Words = std::vector<std::string>;
Words spelled(std::vector<const char*> argv) {
  argv.insert(argv.begin(), "program");
  return without_short_forms(static_cast<int>(argv.size()), argv.data());
}

TEST(dependencies, are_asked_for_as_of_compilers) {
  EXPECT_EQ(spelled({"-MF", "a.d", "-MQ", "b"}),
            (Words{"--set.dependencies", "a.d", "--set.dependencies-target", "b"}));
  EXPECT_EQ(spelled({"-MFa.d", "x", "-MQb"}),
            (Words{"--set.dependencies", "a.d", "x", "--set.dependencies-target", "b"}));
  EXPECT_EQ(spelled({"-M", "--", "-MF", "x"}), (Words{"-M", "--", "-MF", "x"}));
}

TEST(dependencies, are_a_rule_and_an_empty_one_for_each_file) {
  EXPECT_EQ(make_rule("a.exr", {"room.glb", "-", "wall 1.png", "room.glb"}),
            "a.exr: \\\n  room.glb \\\n  wall\\ 1.png\n\nroom.glb:\n\nwall\\ 1.png:\n");
  EXPECT_EQ(make_rule("a", {"-"}), "a:\n");
}

TEST(dependencies, refuse_names_that_make_cannot_write) {
  for (const char* name : {"a;b", "a\tb", "a\nb", "a\\", "lib(member)"})
    EXPECT_THROW(check_make_name(name), UsageError) << name;
  for (const char* name : {"a b", "(a) b", "a:b", "a\\b", "a=b"}) check_make_name(name);
}

TEST(dependencies, are_read_back_by_make_whatever_the_names) {
  if (std::system("make --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "make is missing";
  const testing::TempFolder folder;
  folder.write("Makefile", "out:\n\t@touch out\ninclude d\n");
  const auto make = [&](const std::string& arguments) {
    const std::string there = "cd '" + folder.path.string() + "' && ";
    return std::system((there + "make " + arguments + " >log 2>&1").c_str()) == 0;
  };
  const auto set_time = [&](const std::string& name, int seconds) {
    const auto now = fs::file_time_type::clock::now();
    fs::last_write_time(folder.path / name, now + std::chrono::seconds(seconds));
  };
  for (const std::string name :
       {"plain", "a b", "a#b", "a$b",  "$(a",  "a%b",   "a:b",     "a::b",  "a|b",   "a&b",
        "a&",    "a*b", "a?b", "[ab]", "a\\b", "a\\ b", "a\\\\ b", "a\\#b", "a\\%b", "a=b",
        "a+=b",  "(a",  "'",   "\"",   "~a",   "a,b",   "-a",      "a!",    "{a}",   "\303\244"}) {
    SCOPED_TRACE(name);
    folder.write(name, "");
    set_time(name, -5);
    folder.write("d", make_rule("out", {name}));
    fs::remove(folder.path / "out");
    EXPECT_TRUE(make("out"));
    EXPECT_TRUE(make("-q out")) << "is built for nothing";
    set_time(name, 5);
    EXPECT_FALSE(make("-q out")) << "is not built when it should be";
    fs::remove(folder.path / name);
    EXPECT_TRUE(make("out")) << "what is gone breaks the build";
  }
}

}  // namespace tdpt::cli::outputs_test
