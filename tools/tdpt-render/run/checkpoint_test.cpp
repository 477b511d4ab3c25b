// Parts of a picture, how they identify themselves, and which may resume which.
#include "tools/tdpt-render/run/checkpoint.h"

#include <functional>
#include <tuple>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt::checkpoint_test {

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
  EXPECT_EQ(refusal([](RenderArguments& a) { a.add_samples = 4; }),
            "--add-samples: needs --resume with the film of the picture");
  const testing::TempFolder folder;
  write_output(folder.path / "c.exr", "x");
  const std::string there = folder.path / "c.exr";
  EXPECT_EQ(
      refusal([&](RenderArguments& a) { a.checkpoint = there; }),
      "--checkpoint " + there + ": is there already; go on from it with --resume, or remove it");
  EXPECT_EQ(refusal([&](RenderArguments& a) { a.checkpoint = a.resume = there; }), "");
}

TEST(schedule, tells_what_other_code_does_to_a_film) {
  EXPECT_EQ(other_code_sentence("a.exr", "sse2", "avx2+fma"),
            "a.exr was rendered by code for sse2, this is code for avx2+fma: the last digits may "
            "differ from those of one machine; --set isa=sse2 is alike on all");
  for (const auto& [before, now] :
       {std::pair("sse2", "gpu"), std::pair("gpu", "sse2"), std::pair("gpu, sse2", "sse2")})
    EXPECT_EQ(other_code_sentence("a.exr", before, now),
              std::string("a.exr was rendered by code for ") + before + ", this is code for " +
                  now +
                  ": CPU and GPU agree in the mean, but not in the last digits of each sample");
}

FilmFile film_of(Progress& progress, const Plan& plan) {
  return parse_film(film_bytes(progress, plan, {}, {}), "c.exr");
}

TEST(progress, is_read_as_it_was_written) {
  Plan plan;
  plan.integrator = tdpt_guided;
  plan.label = "tdpt-guided";
  plan.spp = 64;
  plan.explored = {{PortalWay::back, PortalWay::left_out},
                   {0.25, 0.25, 0, 0.5},
                   Truncation{6, 0.25, 0.01},
                   128,
                   0.5};
  plan.error_rounds = {{true, 0, std::numeric_limits<double>::infinity(), 1, 8}};
  plan.needed = 64;
  plan.forecast.estimates = {{"bdpt", false, 0.5, 100, std::numeric_limits<double>::infinity()},
                             {"tdpt", true, 0.25, 200, 50}};
  plan.forecast.best = 1;
  plan.forecast.portals_gain = 2, plan.forecast.gain_low = 1, plan.forecast.gain_high = 4;
  plan.pilot_samples = 64, plan.pilot_cpu_seconds = 0.5;
  Progress a(Film(2, 1, 1), {64, 3600, 0.01, true});
  a.film.complete({16, 4});
  a.first = 16, a.goal = 32, a.added = 8, a.whole = 64, a.retried = 96;
  a.seconds = 12.25, a.cpu_seconds = 24.5, a.began = 0.125;
  a.tally.rays = {1, 2, 3, 4};
  a.tally.begin_portals(2);
  a.tally.portals[1].lit = 7;
  a.tally.portals[1].energy.add(0.5);
  a.tally.energy[2].add(0.25);
  a.blocks.add({{1, 2, 3}, {4, 5, 6}});
  a.frames = {{1, 0.5, {0.1, 0.2, 0.3}, 1, 2}};
  a.tally.not_finite_at = {{17, 0, 1}};
  const FilmFile file = film_of(a, plan);
  const Plan again = plan_of(file.facts, "c.exr");
  Progress b = progress_of(film_of(a, plan), "c.exr");
  EXPECT_EQ(film_of(b, again).facts, file.facts);
  EXPECT_EQ(b.limits, a.limits);
  EXPECT_EQ(b.retried, 96u);
  EXPECT_EQ(b.blocks.blocks(), a.blocks.blocks());
  EXPECT_EQ(b.blocks.before(), a.blocks.before());
  EXPECT_EQ(b.frames, a.frames);
  EXPECT_EQ(b.tally.not_finite_at, a.tally.not_finite_at);
  EXPECT_EQ(b.next(), 20u);
  EXPECT_EQ(b.spp(), 64u);
  EXPECT_EQ(again.integrator.mixture, plan.integrator.mixture);
  EXPECT_EQ(again.explored.ways, plan.explored.ways);
  EXPECT_EQ(again.explored.lights, plan.explored.lights);
  EXPECT_EQ(again.explored.beyond->share, 0.25);
  EXPECT_EQ(again.error_rounds[0].spread, std::numeric_limits<double>::infinity());
  EXPECT_EQ(again.forecast.gain_low, 1);
}

TEST(progress, that_is_no_beginning_is_refused) {
  FilmFacts facts;
  facts.spp = 8;
  Film gap(1, 1, 1);
  gap.complete({0, 2});
  gap.complete({4, 2});
  EXPECT_EQ(complaint([&] {
              progress_of({std::move(gap), facts, {}}, "c.exr");
            }),
            "c.exr:film: holds samples 0 to 1 and 4 to 5, which is no beginning to go on from");
  const auto state = [&](const std::string& text) {
    facts.state = text;
    return complaint([&] { progress_of({Film(1, 1, 1), facts, {}}, "c.exr"); });
  };
  EXPECT_EQ(state("{"), "c.exr:film.state: is no JSON object");
  EXPECT_EQ(state("{}"), "c.exr:film.state.limits: is missing");
}

// Each number of a plan is checked before it is used.
TEST(plan, that_is_out_of_range_is_refused) {
  Plan plan;
  plan.label = "bdpt";
  plan.explored.lights = {1, 0, 0, 0};
  Progress progress(Film(1, 1, 1), {4});
  progress.film.complete({0, 1});
  FilmFacts facts = film_of(progress, plan).facts;
  EXPECT_EQ(complaint([&] { plan_of(facts, "c.exr"); }), "");
  const std::string sound = facts.plan;
  for (const auto& [from, to, place] :
       {std::tuple("\"bdpt\",\"stream\"", "\"none\",\"stream\"", "integrator"),
        {"\"segments\":1.0", "\"segments\":1e9", "mixture.segments"},
        {"\"spp\":0", "\"spp\":-1", "spp"},
        {"\"surfaces\":1.0", "\"surfaces\":0.5", "lights"},
        {"\"portals\":[]", "\"portals\":[{\"portal\":0,\"way\":9}]", "portals.way"},
        {"\"beyond\":null", "\"beyond\":{\"depth\":1e99}", "beyond.depth"}}) {
    facts.plan = sound;
    ASSERT_NE(facts.plan.find(from), std::string::npos) << sound;
    facts.plan.replace(facts.plan.find(from), std::string(from).size(), to);
    EXPECT_NE(complaint([&] { plan_of(facts, "c.exr"); }).find(place), std::string::npos) << to;
  }
}

}  // namespace tdpt::checkpoint_test
