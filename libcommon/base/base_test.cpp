#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::base_test {
namespace fs = std::filesystem;

using testing::refusal;
using testing::TempFolder;

// The standard output of a shell command.
class Pipe {
 public:
  explicit Pipe(const char* command) : end_(::popen(command, "r"), ::pclose) {}
  std::string path() const { return "/proc/self/fd/" + std::to_string(::fileno(end_.get())); }

 private:
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> end_;
};

TEST(memory_limit, sizes_are_read_and_told) {
  EXPECT_EQ(parse_size("1"), 1u);
  EXPECT_EQ(parse_size("1500"), 1500u);
  EXPECT_EQ(parse_size("200M"), 200u << 20);
  EXPECT_EQ(parse_size("1.5G"), 3u << 29);
  EXPECT_EQ(parse_size("8T"), uint64_t{8} << 40);
  for (const char* wrong :
       {"", "0", "-1", "M", "1e9", "1MB", "1 M", "0.1", "nan", "inf", "10000000T"})
    EXPECT_FALSE(parse_size(wrong)) << wrong;
  EXPECT_EQ(size_words(1), "1 byte");
  EXPECT_EQ(size_words(700), "700 bytes");
  EXPECT_EQ(size_words(1536), "1.5 KiB");
  EXPECT_EQ(size_words(1023 << 10), "0.999 MiB");
  EXPECT_EQ(size_words(1023590), "1000 KiB");  // not 1e+03 KiB
  EXPECT_EQ(size_words(uint64_t{3} << 29), "1.5 GiB");
  EXPECT_EQ(size_words(~uint64_t{0}), "1.68e+07 TiB");
}

TEST(number_words, have_no_exponent_at_everyday_magnitudes) {
  EXPECT_EQ(number_words(3141.59), "3140");
  EXPECT_EQ(number_words(9.996e6), "1e+07");
  EXPECT_EQ(number_words(9.994e6), "9990000");
  EXPECT_EQ(number_words(0.00031), "0.00031");
  EXPECT_EQ(number_words(0.0001), "0.0001");
  EXPECT_EQ(number_words(0.000031), "3.1e-05");
  EXPECT_EQ(number_words(-1234567, 2), "-1200000");
  EXPECT_EQ(number_words(1, 2), "1");
  EXPECT_EQ(number_words(0), "0");
  EXPECT_EQ(number_words(HUGE_VAL), "inf");
}

TEST(number_words, of_shares_are_per_cent) {
  EXPECT_EQ(percent_words(1), "100 %");
  EXPECT_EQ(percent_words(0.153), "15 %");
  EXPECT_EQ(percent_words(0.153, 3), "15.3 %");
  EXPECT_EQ(percent_words(0.00012), "0.012 %");
}

TEST(memory_limit, no_file_is_read_beyond_it) {
  const TempFolder folder;
  const std::string text = folder.write("text", std::string(size_t{3} << 20, 'x'));
  const Pipe endless("seq 1000000000");
  const std::string pipe = endless.path();
  const uint64_t machine = memory_limit();
  limit_memory(2 << 20);
  for (const std::string& name : {text, pipe})
    EXPECT_EQ(refusal<InputError>([&] { read_file(name); }).find(name + ": is larger"), 0u);
  limit_memory(machine);
}

TEST(read_file, of_endless_noise_takes_the_beginning) {
  EXPECT_EQ(read_file("/dev/zero").size(), 65536u);
  EXPECT_EQ(read_file("/dev/urandom").size(), 65536u);
  EXPECT_EQ(read_file(Pipe("yes").path()).size(), 65536u);
  EXPECT_EQ(read_file(Pipe("yes | head -n 100000; echo end").path()).size(), 65536u);
  EXPECT_EQ(read_file(Pipe("yes | head -n 1000").path()).size(), 2000u);
  EXPECT_EQ(read_file(Pipe("seq 100000").path()).size(), 588895u);
}

TEST(memory_limit, what_takes_more_is_refused_with_both_numbers) {
  const uint64_t machine = memory_limit();
  EXPECT_GT(machine, uint64_t{64} << 20);
  limit_memory(100 << 20);
  EXPECT_NO_THROW(expect_memory("a.exr", "", "2 x 2 pixels", 100 << 20));
  EXPECT_NE(refusal<InputError>([] {
              expect_memory("a.exr", "data window", "9 x 9 pixels", (100 << 20) + 1);
            }).find("a.exr:data window: 9 x 9 pixels take 100 MiB"),
            std::string::npos);
  limit_memory(machine);
}

TEST(shell_quoted, words_come_out_of_a_shell_as_they_went_in) {
  EXPECT_EQ(shell_quoted("out/a-1.0-of-2.exr"), "out/a-1.0-of-2.exr");
  EXPECT_EQ(shell_quoted(""), "''");
  EXPECT_EQ(shell_quoted("my room.glb"), "'my room.glb'");
  EXPECT_EQ(shell_quoted("it's $HOME"), "'it'\\''s $HOME'");
  for (const char* meta : {"a*", "~", "a;b", "a\nb", "#a", "a\\b", "a&"})
    EXPECT_EQ(shell_quoted(meta), std::string("'") + meta + "'");
}

TEST(counted, says_one_mesh_and_three_meshes) {
  EXPECT_EQ(counted(0, "sample"), "0 samples");
  EXPECT_EQ(counted(1u, "sample"), "1 sample");
  EXPECT_EQ(counted(uint64_t{1}, "mesh"), "1 mesh");
  for (const char* noun : {"mesh", "batch", "glass", "box"})
    EXPECT_EQ(counted(size_t{3}, noun), std::string("3 ") + noun + "es");
}

TEST(output_file, appears_complete_and_leaves_no_temporary) {
  const TempFolder folder;
  const std::string name = folder.path / "a.txt";
  write_output(name, "hello");
  EXPECT_EQ(read_file(name), "hello");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 1);
}

TEST(output_file, where_none_can_be_is_an_output_error) {
  const TempFolder folder;
  EXPECT_EQ(refusal<OutputError>([] {
              write_output("/nonexistent-folder/a.txt", "x");
            }).find("/nonexistent-folder/a.txt: cannot be created"),
            0u);
  EXPECT_THROW(write_output(folder.path, "x"), OutputError);
}

TEST(output_file, a_read_only_file_is_not_replaced_even_by_the_super_user) {
  const TempFolder folder;
  const std::string name = folder.path / "keep.txt";
  write_output(name, "original");
  fs::permissions(name, fs::perms::owner_read | fs::perms::group_read);
  EXPECT_THROW(write_output(name, "other"), OutputError);
  EXPECT_THROW(check_output(name), OutputError);
  EXPECT_EQ(read_file(name), "original");
}

TEST(output_files, are_all_there) {
  const TempFolder folder;
  write_outputs({{folder.path / "a", "first"}, {folder.path / "b", "second"}});
  EXPECT_EQ(read_file(folder.path / "a"), "first");
  EXPECT_EQ(read_file(folder.path / "b"), "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 2);
}

// Whichever file cannot be written, and whether creation or a later write fails.
TEST(output_files, leave_everything_as_it_was_when_one_cannot_be_written) {
  const TempFolder folder;
  const std::string kept = folder.path / "kept", fresh = folder.path / "fresh";
  write_output(kept, "old");
  for (const std::string& bad :
       {std::string(folder.path / "nowhere" / "b"), std::string("/dev/full")}) {
    EXPECT_THROW(write_outputs({{kept, "new"}, {fresh, "new"}, {bad, "x"}}), OutputError);
    EXPECT_THROW(write_outputs({{bad, "x"}, {fresh, "new"}, {kept, "new"}}), OutputError);
  }
  EXPECT_EQ(read_file(kept), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 1);
}

// If a folder replaces a file after the check, only the rename fails.
TEST(output_files, get_their_names_the_first_one_last) {
  const TempFolder folder;
  const std::string first = folder.path / "first", second = folder.path / "second";
  const std::string pipe = folder.path / "pipe", other_pipe = folder.path / "other_pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(other_pipe.c_str(), 0600), 0);
  std::thread meddler([&] {  // between the pipes all is on disk, without its final name
    EXPECT_EQ(read_file(pipe), "x");
    fs::create_directory(second);
    EXPECT_EQ(read_file(other_pipe), "y");
  });
  EXPECT_THROW(write_outputs({{first, "1"}, {second, "2"}, {pipe, "x"}, {other_pipe, "y"}}),
               OutputError);
  meddler.join();
  EXPECT_FALSE(fs::exists(first));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 3);
}

TEST(phases, follow_each_other_and_add_up_by_name) {
  Phases phases;
  phases.done("load");
  phases.done("walk");
  phases.done("load");
  ASSERT_EQ(phases.all().size(), 2u);
  EXPECT_EQ(phases.all()[0].name, "load");
  EXPECT_EQ(phases.all()[1].name, "walk");
  for (const Phases::Phase& p : phases.all()) {
    EXPECT_GE(p.seconds, 0);
    EXPECT_GE(p.cpu_seconds, 0);
  }
}

TEST(phases, the_peak_of_the_memory_grows_with_what_is_held) {
  const int64_t before = peak_memory();
  const std::vector<char> held(1 << 27, 1);
  EXPECT_GE(peak_memory(), static_cast<int64_t>(held.size()));
  EXPECT_GE(peak_memory(), before);
}

TEST(output_file, is_kept_elsewhere_under_a_name_of_its_own) {
  const TempFolder folder;
  ::setenv("TMPDIR", folder.path.c_str(), 1);
  const std::string first = keep_elsewhere("/nowhere/room.exr", "a");
  const std::string second = keep_elsewhere("room.exr", "b");
  ::unsetenv("TMPDIR");
  EXPECT_NE(first, second);
  EXPECT_EQ(first.rfind(folder.path.string() + "/room-", 0), 0u);
  EXPECT_TRUE(first.ends_with(".exr"));
  EXPECT_EQ(read_file(first), "a");
  EXPECT_EQ(read_file(second), "b");
}

TEST(file, missing_file_is_an_input_error_with_its_name) {
  EXPECT_EQ(refusal<InputError>([] { read_file("/nonexistent.glb"); }).find("/nonexistent.glb: "),
            0u);
}

TEST(hash, of_a_file_is_that_of_its_bytes) {
  EXPECT_EQ(content_hash("").size(), 32u);
  EXPECT_NE(content_hash("a"), content_hash("b"));
  const TempFolder folder;
  for (const size_t size : {size_t{0}, size_t{1}, (size_t{1} << 20) + 1}) {
    const std::string bytes(size, 'x');
    EXPECT_EQ(content_hash_of_file(folder.write("bytes", bytes)), content_hash(bytes)) << size;
  }
  EXPECT_THROW(content_hash_of_file(folder.path / "missing"), InputError);
  EXPECT_THROW(content_hash_of_file(folder.path), InputError);
}

TEST(provenance, names_are_those_of_files_and_keep_to_their_line) {
  Provenance p;
  p.made_by("tool", "tool --camera a\nb");
  p.from("/some/folder/line\nbreak.glb", "00");
  EXPECT_TRUE(p.lines[0].ends_with(": tool --camera a?b"));
  EXPECT_EQ(p.lines[1], "from line?break.glb 00");
}

}  // namespace tdpt::base_test
