// Parts of a picture, how they identify themselves, and which may resume which.
#include "tools/tdpt-render/run/progress.h"

#include <functional>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt::progress_test {

std::string complaint(const std::function<void()>& work) {
  try {
    work();
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(shard, takes_its_part_and_all_parts_are_the_whole) {
  for (const uint64_t samples : {1ull, 7ull, 16ull, 1000ull, 1ull << 32})
    for (const uint64_t of : {1ull, 2ull, 7ull, 16ull, 1000ull}) {
      uint64_t next = 0;
      for (uint64_t i = 0; i < of; ++i) {
        const SampleRange part =
            samples_of_shard(std::to_string(i) + "/" + std::to_string(of), samples);
        ASSERT_EQ(part.first, next);
        EXPECT_LE(part.count, samples / of + 1);
        EXPECT_GE(part.count, samples / of);
        next = part.end();
      }
      EXPECT_EQ(next, samples);
    }
  for (const char* bad : {"", "3", "/", "3/", "/4", "4/4", "-1/4", "1/4x", "x1/4", "1 /4",
                          "1/99999999", "1/0", "0/0", "99999999999999999999/100000000000000000000"})
    EXPECT_NE(complaint([&] { samples_of_shard(bad, 16); }), "") << bad;
}

TEST(options, that_contradict_each_other_are_refused) {
  const auto refusal = [](const std::function<void(RenderArguments&)>& change) {
    RenderArguments a;
    change(a);
    return complaint([&] { check_options(a), check_checkpoint(a); });
  };
  EXPECT_EQ(refusal([](RenderArguments&) {}), "");
  EXPECT_EQ(refusal([](RenderArguments& a) { a.shard = "0/2", a.spp = 4; }), "");
  EXPECT_NE(refusal([](RenderArguments& a) { a.shard = "0/2"; }).find("needs --spp"),
            std::string::npos);
  for (double RenderArguments::*limit : {&RenderArguments::seconds, &RenderArguments::target_error})
    EXPECT_NE(refusal([&](RenderArguments& a) {
                a.shard = "0/2", a.spp = 4, a.*limit = 1;
              }).find("needs --spp"),
              std::string::npos);
  EXPECT_NE(refusal([](RenderArguments& a) { a.add_samples = 4; }).find("needs --resume"),
            std::string::npos);
  const testing::TempFolder folder;
  write_output(folder.path / "c.exr", "x");
  const std::string there = folder.path / "c.exr";
  EXPECT_NE(refusal([&](RenderArguments& a) { a.checkpoint = there; }).find("is there already"),
            std::string::npos);
  EXPECT_EQ(refusal([&](RenderArguments& a) { a.checkpoint = a.resume = there; }), "");
}

TEST(schedule, tells_what_other_code_does_to_a_film) {
  const auto says = [](const char* before, const char* now, const char* words) {
    return other_code_sentence("a.exr", before, now).find(words) != std::string::npos;
  };
  EXPECT_TRUE(says("sse2", "avx2+fma", "--set isa=sse2"));
  EXPECT_TRUE(says("sse2", "gpu", "agree in the mean"));
  EXPECT_TRUE(says("gpu, sse2", "sse2", "agree in the mean"));
}

FilmFile film_of(Progress& progress, const Plan& plan) {
  return parse_film(film_bytes(progress, plan, {}, {}), "c.exr");
}

TEST(progress, is_read_as_it_was_written) {
  Plan plan;
  plan.label = "tdpt-guided";
  plan.explored.samples = 2457.6;
  Progress a(Film(2, 1, 1), {64, 3600, 0.01});
  a.film.complete({16, 4});
  a.first = 16, a.goal = 32, a.added = 8, a.whole = 64;
  a.seconds = 12.25, a.cpu_seconds = 24.5, a.began = 0.125;
  a.error_pilot = {{true, 0.25, std::numeric_limits<double>::infinity(), 2, 8}, 64, 0.5};
  a.tally.rays = {1, 2, 3, 4};
  a.tally.begin_portals(2);
  a.tally.portals[1].lit = 7;
  a.tally.portals[1].energy.add(0.5);
  a.tally.energy[2].add(0.25);
  a.blocks.add({{1, 2, 3}, {4, 5, 6}});
  const FilmFile file = film_of(a, plan);
  Progress b = progress_of(film_of(a, plan), "c.exr");
  EXPECT_EQ(film_of(b, plan).facts, file.facts);
  EXPECT_EQ(label_in(file.facts.plan), "tdpt-guided");
  EXPECT_EQ(explored_in(file.facts.plan), 2457.6);
  EXPECT_EQ(b.limits, a.limits);
  EXPECT_EQ(b.error_pilot.needed, 64u);
  EXPECT_EQ(b.error_pilot.estimate.relmse, 0.25);
  EXPECT_GT(b.error_pilot.estimate.spread, 1e6);
  EXPECT_EQ(b.blocks.blocks(), a.blocks.blocks());
  EXPECT_EQ(b.blocks.before(), a.blocks.before());
  EXPECT_EQ(b.next(), 20u);
  EXPECT_EQ(b.spp(), 64u);
}

// Whatever was decided by measuring is in it, so that parts by other decisions are not mixed.
TEST(plan, words_are_those_of_one_plan) {
  const auto words = [](const std::function<void(Plan&)>& change) {
    Plan plan;
    change(plan);
    return plan_words(plan);
  };
  const std::string plain = words([](Plan&) {});
  EXPECT_EQ(words([](Plan&) {}), plain);
  EXPECT_NE(words([](Plan& p) { p.label = "nee"; }), plain);
  EXPECT_NE(words([](Plan& p) { p.integrator.mixture.segments = 0.25; }), plain);
  EXPECT_NE(words([](Plan& p) { p.explored.ways = {PortalWay::back}; }), plain);
  EXPECT_NE(words([](Plan& p) { p.explored.lights.sky = 0.5; }), plain);
}

TEST(progress, that_is_no_beginning_is_refused) {
  FilmFacts facts;
  facts.spp = 8;
  Film gap(1, 1, 1);
  gap.complete({0, 2});
  gap.complete({4, 2});
  EXPECT_NE(complaint([&] {
              progress_of({std::move(gap), facts, {}}, "c.exr");
            }).find("samples 0 to 1 and 4 to 5"),
            std::string::npos);
}

// Each number of a state is checked before it is used.
TEST(progress, that_is_out_of_range_is_refused) {
  Progress progress(Film(1, 1, 1), {4});
  progress.film.complete({0, 1});
  progress.goal = 4;
  FilmFacts facts = film_of(progress, {}).facts;
  const std::string sound = facts.state;
  const auto refusal = [&](const std::string& state) {
    facts.state = state;
    return complaint([&] { progress_of({Film(1, 1, 1), facts, {}}, "c.exr"); });
  };
  EXPECT_EQ(refusal(sound), "");
  EXPECT_NE(refusal("{").find("c.exr:film.state: is no JSON"), std::string::npos);
  EXPECT_NE(refusal("{}").find("c.exr:film.state.spp:"), std::string::npos);
  for (const auto& [from, to, place] :
       {std::tuple("\"goal\":4", "\"goal\":-1", "state.goal"),
        {"\"goal\":4", "\"goal\":4.5", "state.goal"},
        {"\"seconds\":0.0", "\"seconds\":null", "state.seconds"},
        {"\"relmse\":0.0", "\"relmse\":1e99", "state.relmse"},
        {"\"block_samples\":1", "\"block_samples\":0", "state.block_samples"}}) {
    std::string state = sound;
    ASSERT_NE(state.find(from), std::string::npos) << state;
    state.replace(state.find(from), std::string(from).size(), to);
    EXPECT_NE(refusal(state).find(place), std::string::npos) << to;
  }
}

}  // namespace tdpt::progress_test
