#include "libcommon/base/progress.h"

#include <sstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tdpt::progress_test {

// Lines that `work` writes to stderr, which is no terminal.
template <class Work>
std::vector<std::string> told(ProgressForm form, const Work& work) {
  show_progress_as(form);
  ::testing::internal::CaptureStderr();
  work();
  std::istringstream text(::testing::internal::GetCapturedStderr());
  show_progress_as(ProgressForm::automatic);
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

TEST(progress, as_json_tells_how_the_work_ended_quiet_or_not) {
  for (const bool quiet : {false, true}) {
    const auto lines = told(ProgressForm::json, [&] {
      ProgressBar progress("tracing", "rays", 10, quiet);
      progress.advance(4);
      progress.tell("a \"note\\\"\n");
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    });
    ASSERT_EQ(lines.size(), 1u);
    const auto all = nlohmann::json::parse(lines[0]);
    ASSERT_EQ(all.size(), 1u);
    const auto& p = all.at("progress");
    EXPECT_EQ(p.size(), 8u);
    EXPECT_EQ(p.at("what"), "tracing");
    EXPECT_EQ(p.at("unit"), "rays");
    EXPECT_EQ(p.at("done"), 4);
    EXPECT_EQ(p.at("total"), 10);
    EXPECT_EQ(p.at("note"), "a \"note\\\"\n");
    const double seconds = p.at("seconds"), rate = p.at("rate"), left = p.at("left");
    EXPECT_GE(seconds, 0.02);
    EXPECT_NEAR(rate * seconds, 4, 0.2);
    EXPECT_NEAR(rate * left, 6, 0.3);
  }
}

TEST(progress, as_json_knows_what_it_does_not_know) {
  const auto lines = told(ProgressForm::json, [] {
    { ProgressBar progress("measuring", "samples", 0, false); }
    { ProgressBar progress("rendering", "samples", 5, false); }
    ProgressBar progress("rendering", "samples", 0, false);
    progress.ends_after(60);
    progress.advance(5);
  });
  ASSERT_EQ(lines.size(), 3u);
  const auto measuring = nlohmann::json::parse(lines[0]).at("progress");
  EXPECT_TRUE(measuring.at("total").is_null());
  EXPECT_TRUE(measuring.at("left").is_null());
  EXPECT_FALSE(measuring.contains("note"));
  const auto rendering = nlohmann::json::parse(lines[1]).at("progress");
  EXPECT_EQ(rendering.at("total"), 5);
  EXPECT_EQ(rendering.at("rate"), 0);
  EXPECT_TRUE(rendering.at("left").is_null());
  // By the clock.
  const auto timed = nlohmann::json::parse(lines[2]).at("progress");
  EXPECT_TRUE(timed.at("total").is_null());
  EXPECT_NEAR(timed.at("seconds").get<double>() + timed.at("left").get<double>(), 60, 0.01);
}

TEST(progress, as_json_is_told_every_third_of_a_second) {
  const auto lines = told(ProgressForm::json, [] {
    ProgressBar progress("tracing", "rays", 0, false);
    const auto work = [&] {
      const auto start = std::chrono::steady_clock::now();
      while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(800))
        progress.advance(1);
    };
    std::thread another(work);
    work();
    another.join();
  });
  ASSERT_GE(lines.size(), 2u);
  double seconds = 0;
  uint64_t done = 0;
  for (const std::string& line : lines) {
    const auto p = nlohmann::json::parse(line).at("progress");
    EXPECT_GE(p.at("seconds"), seconds);
    EXPECT_GE(p.at("done"), done);
    seconds = p.at("seconds");
    done = p.at("done");
  }
  EXPECT_LE(static_cast<double>(lines.size()), seconds / 0.3 + 1.01);
}

}  // namespace tdpt::progress_test
