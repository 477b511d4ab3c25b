#include "libcommon/base/child_process.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "libcommon/base/file.h"
#include "libcommon/testing/files/refusal.h"

namespace tdpt::child_process_test {

int wait_for(ChildProcess& child, std::string& text) {
  while (child.read(text)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  while (!child.exit_code()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return *child.exit_code();
}

// The number that a script writes into a file, once it is there.
pid_t number_in(const std::string& path) {
  for (int i = 0; i < 1000; ++i) {
    pid_t pid = 0;
    if (std::ifstream(path) >> pid) return pid;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return 0;
}

bool ends_within(int tries, pid_t pid) {
  for (int i = 0; i < tries; ++i) {
    if (::kill(pid, 0) != 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

std::string temporary(const char* name) {
  return ::testing::TempDir() + "child_process_test." + std::to_string(::getpid()) + "." + name;
}

TEST(child_process, words_reach_the_program_as_they_are) {
  std::string text;
  ChildProcess child(
      {"/bin/sh", "-c", "printf '%s|' \"$@\" >&2; exit 7", "sh", "a$(id)", "", "b `c`&;'\"\n"}, {});
  EXPECT_EQ(wait_for(child, text), 7);
  EXPECT_EQ(text, "a$(id)||b `c`&;'\"\n|");
}

TEST(child_process, a_program_that_is_not_there_or_ends_by_a_signal_is_told_as_shells_do) {
  std::string text;
  ChildProcess none({"/nowhere/program"}, {});
  EXPECT_EQ(wait_for(none, text), 1);
  EXPECT_EQ(text.find("/nowhere/program: cannot be started"), 0u) << text;
  ChildProcess killed({"/bin/sh", "-c", "kill -9 $$"}, {});
  EXPECT_EQ(wait_for(killed, text), 137);
}

TEST(child_process, is_killed_with_its_object) {
  const std::string file = temporary("object");
  pid_t pid = 0;
  {
    ChildProcess child({"/bin/sh", "-c", "echo $$ >\"$1\"; exec sleep 60", "sh", file}, {});
    pid = number_in(file);
    ASSERT_GT(pid, 0);
  }
  EXPECT_NE(::kill(pid, 0), 0);
  ::unlink(file.c_str());
}

// A copy of this process starts a child and is killed. `tied`: the child is started by
// ChildProcess; else by fork() alone.
bool child_ends_with_its_parent(bool tied) {
  const std::string file = temporary(tied ? "tied" : "free");
  ::unlink(file.c_str());
  const pid_t copy = ::fork();
  if (copy == 0) {
    const std::vector<std::string> words{"/bin/sh", "-c", "echo $$ >\"$1\"; exec sleep 60", "sh",
                                         file};
    if (tied) {
      ChildProcess child(words, {});
      ::pause();
    } else if (::fork() == 0) {
      ::execl("/bin/sh", "sh", "-c", words[2].c_str(), "sh", file.c_str(), nullptr);
    }
    ::pause();
  }
  const pid_t pid = number_in(file);
  EXPECT_GT(pid, 0);
  ::kill(copy, SIGKILL);
  ::waitpid(copy, nullptr, 0);
  const bool ended = ends_within(tied ? 400 : 40, pid);
  if (!ended) ::kill(pid, SIGKILL);
  ::unlink(file.c_str());
  return ended;
}

TEST(child_process, ends_when_this_process_is_killed) {
  EXPECT_TRUE(child_ends_with_its_parent(true));
  EXPECT_FALSE(child_ends_with_its_parent(false)) << "twin: a child that is not tied";
}

TEST(child_process, only_the_main_thread_may_start_one) {
  std::thread([] { EXPECT_THROW(ChildProcess({"/bin/true"}, {}), Error); }).join();
}

constexpr size_t kLong = 1 << 20;  // more than a pipe holds

bool gives(const std::function<void(std::FILE*)>& after) {
  const std::string text(kLong, 'x');
  return in_another_process(
      [&](std::FILE* out) {
        std::fwrite(text.data(), 1, text.size(), out);
        std::fflush(out);
        after(out);
      },
      [&](std::FILE* in) {
        std::string got(kLong, ' ');
        return std::fread(got.data(), 1, kLong, in) == kLong && got == text &&
               std::fgetc(in) == EOF;
      });
}

// However it ends, even after everything was written.
TEST(another_process, that_ends_before_its_work_gave_nothing) {
  EXPECT_TRUE(gives([](std::FILE*) {}));
  EXPECT_FALSE(gives([](std::FILE*) { std::abort(); }));
  EXPECT_FALSE(gives([](std::FILE*) { ::kill(::getpid(), SIGSEGV); }));
  EXPECT_FALSE(gives([](std::FILE*) { ::kill(::getpid(), SIGKILL); }));
  EXPECT_FALSE(gives([](std::FILE*) { ::_exit(3); }));
  EXPECT_FALSE(gives([](std::FILE*) { throw std::runtime_error("no"); }));
  EXPECT_FALSE(gives([](std::FILE* out) { std::fputc('x', out); }));
}

TEST(another_process, takes_no_more_than_the_limit_of_memory) {
  const auto takes = [](size_t bytes) {
    return gives([=](std::FILE*) { const std::string much(bytes, 'x'); });
  };
  const uint64_t machine = memory_limit();
  limit_memory(64 << 20);
  EXPECT_TRUE(takes(32 << 20));
  EXPECT_FALSE(takes(size_t{256} << 20));
  limit_memory(machine);
  EXPECT_TRUE(takes(size_t{256} << 20));
}

TEST(another_process, is_waited_for_when_what_reads_it_throws) {
  const auto endless = [](std::FILE* out) {
    while (std::fputc('x', out) != EOF) continue;
  };
  EXPECT_THROW(in_another_process(endless, [](std::FILE*) -> bool { throw std::bad_alloc(); }),
               std::bad_alloc);
  EXPECT_FALSE(in_another_process(endless, [](std::FILE*) { return true; }));
}

TEST(another_process, that_cannot_be_had_is_told) {
  rlimit files;
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlimit none{0, files.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string said = testing::refusal([] { gives([](std::FILE*) {}); });
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &files), 0);
  EXPECT_NE(said.find("Too many open files"), std::string::npos);
}

}  // namespace tdpt::child_process_test
