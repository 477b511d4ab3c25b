#include "libcommon/cli/outputs.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"

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

// A folder in which make builds `out` with the dependency file `d`.
class Folder {
 public:
  Folder() {
    fs::create_directories(path_);
    write("Makefile", "out:\n\t@touch out\ninclude d\n");
  }
  ~Folder() { fs::remove_all(path_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
  }
  void remove(const std::string& name) const { fs::remove(path_ / name); }
  void make_newer(const std::string& name) const {
    fs::last_write_time(path_ / name, fs::file_time_type::clock::now() + std::chrono::seconds(5));
  }
  void make_older(const std::string& name) const {
    fs::last_write_time(path_ / name, fs::file_time_type::clock::now() - std::chrono::seconds(5));
  }
  bool make(const std::string& arguments) const {
    return std::system(
               ("cd '" + path_.string() + "' && make " + arguments + " >log 2>&1").c_str()) == 0;
  }

 private:
  fs::path path_ = fs::temp_directory_path() / ("tdpt_dependencies." + std::to_string(::getpid()));
};

TEST(dependencies, are_read_back_by_make_whatever_the_names) {
  if (std::system("make --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "make is missing";
  const Folder folder;
  for (const std::string name :
       {"plain", "a b", "a#b", "a$b",  "$(a",  "a%b",   "a:b",     "a::b",  "a|b",   "a&b",
        "a&",    "a*b", "a?b", "[ab]", "a\\b", "a\\ b", "a\\\\ b", "a\\#b", "a\\%b", "a=b",
        "a+=b",  "(a",  "'",   "\"",   "~a",   "a,b",   "-a",      "a!",    "{a}",   "\303\244"}) {
    SCOPED_TRACE(name);
    folder.write(name, "");
    folder.make_older(name);
    folder.write("d", make_rule("out", {name}));
    folder.remove("out");
    EXPECT_TRUE(folder.make("out"));
    EXPECT_TRUE(folder.make("-q out")) << "is built for nothing";
    folder.make_newer(name);
    EXPECT_FALSE(folder.make("-q out")) << "is not built when it should be";
    folder.remove(name);
    EXPECT_TRUE(folder.make("out")) << "what is gone breaks the build";
  }
}

}  // namespace tdpt::cli::outputs_test
