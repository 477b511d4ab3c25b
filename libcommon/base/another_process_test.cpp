#include "libcommon/base/another_process.h"

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"

namespace tdpt::another_process_test {

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

TEST(another_process, gives_back_what_it_writes) {
  EXPECT_TRUE(gives([](std::FILE*) {}));
}

// However it ends, even after everything was written.
TEST(another_process, that_ends_before_its_work_gave_nothing) {
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

TEST(another_process, may_be_limited_in_memory_and_time) {
  const auto fill = [](size_t bytes) {
    volatile char* const room = new char[bytes];
    for (size_t i = 0; i < bytes; i += 4096) room[i] = 1;
  };
  const auto compute = [] {
    for (volatile bool on = true; on;) continue;
  };
  const auto limited = [&](std::FILE*) { limit_this_process(size_t{64} << 20, 1); };
  EXPECT_TRUE(gives([&](std::FILE* out) { limited(out), fill(size_t{32} << 20); }));
  EXPECT_FALSE(gives([&](std::FILE* out) { limited(out), fill(size_t{256} << 20); }));
  EXPECT_FALSE(gives([&](std::FILE* out) { limited(out), compute(); }));
}

TEST(another_process, that_cannot_be_had_is_told) {
  rlimit files;
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlimit none{0, files.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  std::string said;
  try {
    gives([](std::FILE*) {});
  } catch (const Error& e) {
    said = e.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &files), 0);
  EXPECT_EQ(said, "no other process can be started: Too many open files");
}

}  // namespace tdpt::another_process_test
