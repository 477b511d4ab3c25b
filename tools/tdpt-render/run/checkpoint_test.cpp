// Parts of a picture, how they identify themselves, and which may resume which.
#include "tools/tdpt-render/run/checkpoint.h"

#include <functional>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/testing/rooms.h"

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
        const SampleRange part = Shard{i, of}.part(0, samples);
        ASSERT_EQ(part.first, next);
        EXPECT_LE(part.count, samples / of + 1);
        EXPECT_GE(part.count, samples / of);
        next = part.end();
      }
      EXPECT_EQ(next, samples);
    }
  EXPECT_EQ((Shard{3, 4}.part(64, 64)), (SampleRange{112, 16}));
}

TEST(shard, is_read_or_refused) {
  EXPECT_EQ(shard_of("3/16").index, 3u);
  EXPECT_EQ(shard_of("3/16").of, 16u);
  for (const char* bad : {"", "3", "/", "3/", "/4", "4/4", "-1/4", "1/4x", "x1/4", "1 /4",
                          "1/99999999", "1/0", "0/0", "99999999999999999999/100000000000000000000"})
    EXPECT_NE(complaint([&] { shard_of(bad); }), "") << bad;
}

Arguments with(const std::function<void(Arguments&)>& change) {
  Arguments a;
  change(a);
  return a;
}

TEST(schedule, options_that_contradict_each_other_are_refused) {
  const auto refusal = [](const std::function<void(Arguments&)>& change) {
    return complaint([&] { check_schedule(with(change)); });
  };
  EXPECT_EQ(refusal([](Arguments&) {}), "");
  EXPECT_EQ(refusal([](Arguments& a) { a.shard = "0/2"; }),
            "--shard: needs --spp, or --plan with the number of samples");
  EXPECT_EQ(refusal([](Arguments& a) { a.shard = "0/2", a.spp = 4; }), "");
  EXPECT_EQ(refusal([](Arguments& a) { a.shard = "0/2", a.plan = "p"; }), "");
  EXPECT_EQ(refusal([](Arguments& a) { a.shard = "0/2", a.spp = 4, a.seconds = 1; }),
            "--shard: needs a number of samples; --plan makes one of --time or --target-error");
  EXPECT_EQ(refusal([](Arguments& a) { a.shard = "0/2", a.plan = "p", a.seconds = 1; }), "");
  EXPECT_EQ(refusal([](Arguments& a) { a.add_samples = 4; }),
            "--add-samples: needs --resume with the film of the picture");
  EXPECT_EQ(refusal([](Arguments& a) { a.plan = "p", a.resume = "c"; }),
            "--plan: nothing is decided with --resume, which obeys its own plan");
  const testing::TempFolder folder;
  write_output(folder.path / "c.exr", "x");
  const std::string there = folder.path / "c.exr";
  EXPECT_EQ(
      refusal([&](Arguments& a) { a.checkpoint = there; }),
      "--checkpoint " + there + ": is there already; go on from it with --resume, or remove it");
  EXPECT_EQ(refusal([&](Arguments& a) { a.checkpoint = a.resume = there; }), "");
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

TEST(schedule, commands_of_shards_are_for_a_shell) {
  Arguments a;
  a.plan = "p";
  a.shard = "all/2";
  const std::vector<std::string> words{
      "tdpt-render",   "my room.glb", "--plan",        "p", "-o", "out/a.exr",
      "--shard=all/2", "--camera",    "the 'left' one"};
  EXPECT_EQ(shard_commands(a, words, "out/a.exr"),
            "tdpt-render 'my room.glb' --plan p --camera 'the '\\''left'\\'' one' --shard 0/2 -o "
            "out/a.0-of-2.exr\n"
            "tdpt-render 'my room.glb' --plan p --camera 'the '\\''left'\\'' one' --shard 1/2 -o "
            "out/a.1-of-2.exr\n");
  a.checkpoint = "c.exr";
  EXPECT_EQ(
      shard_commands(a, {"tdpt-render", "a.glb", "--checkpoint", "c.exr", "-oa.exr"}, "a.exr"),
      "tdpt-render a.glb --shard 0/2 -o a.0-of-2.exr --checkpoint a.0-of-2.checkpoint.exr "
      "--resume a.0-of-2.checkpoint.exr\n"
      "tdpt-render a.glb --shard 1/2 -o a.1-of-2.exr --checkpoint a.1-of-2.checkpoint.exr "
      "--resume a.1-of-2.checkpoint.exr\n");
  EXPECT_EQ(merge_command(a, "out/a.exr"), "exrmerge out/a.*-of-2.exr -o out/a.exr");
  EXPECT_EQ(merge_command(a, "my d.o/a"), "exrmerge 'my d.o/a'.*-of-2.exr -o 'my d.o/a'");
  EXPECT_NE(complaint([&] { shard_commands(a, {}, "-"); }), "");
  a.stats = "s";
  EXPECT_NE(complaint([&] { shard_commands(a, {}, "a.exr"); }), "");
  EXPECT_NE(complaint([&] {
              Arguments endless;
              endless.shard = "all/2";
              shard_commands(endless, {}, "a.exr");
            }),
            "");
}

// A plan, a checkpoint or a shard of another camera is refused.
TEST(shape, has_the_camera_with_what_it_culls) {
  Scene scene = read_gltf(two_rooms_path());
  Camera camera = scene.camera("");
  Arguments a;
  EXPECT_EQ(camera_words(a, {{1, 2, 3}, 0.5}, camera), "camera");
  camera.culls = true;
  EXPECT_EQ(camera_words(a, {{1, 2, 3}, 0.5}, camera), "camera --cull");
  camera = {"--look-from", {1, 2, 3}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 0.5, 0, true};
  a.camera.look_from = "1,2,3";
  EXPECT_EQ(camera_words(a, {{1, 2, 3}, 0.5}, camera),
            "3 6 9 0 0 -1 0 1 0 0.5 0 fronts --look-from");
}

TEST(shape, differs_where_the_picture_would) {
  const Scene scene = read_gltf(two_rooms_path());
  const Shaping by{scene, {}, "camera", {"12"}, 64, 48, 1};
  const Shape shape = film_shape_of({}, by);
  const auto told = [&](const std::function<void(Arguments&, Shaping&)>& change) {
    Arguments a;
    Shaping other = by;
    change(a, other);
    return difference(film_shape_of(a, other), shape);
  };
  EXPECT_EQ(told([](Arguments&, Shaping&) {}), "");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.spp = 3, a.seconds = 4, a.target_error = 1; }), "");
  EXPECT_EQ(told([](Arguments&, Shaping& s) { s.seed = 2; }), "another seed (2, expected 1)");
  EXPECT_EQ(told([](Arguments&, Shaping& s) { s.portal_hashes.clear(); }),
            "another portal (none, expected 12)");
  EXPECT_EQ(told([](Arguments&, Shaping& s) { s.width = 32; }),
            "another size (32 x 48, expected 64 x 48)");
  EXPECT_NE(told([](Arguments&, Shaping& s) {
              s.sky = {"1,1,1", 0, 2};
            }).find("environment"),
            std::string::npos);
  EXPECT_EQ(told([](Arguments&, Shaping& s) { s.camera = "b"; }),
            "another camera (b, expected camera)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.max_depth = 6; }),
            "another depth (6, expected any)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.integrator = "pt"; }),
            "another integrator (pt, expected auto)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.segments = 0.5; }),
            "another integrator (auto segments 0.5, expected auto)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.mis = "power"; }),
            "another heuristic (power, expected balance)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.alpha = true; }),
            "another film (transparent, expected opaque)");
  EXPECT_EQ(told([](Arguments& a, Shaping&) { a.layers = true; }),
            "another set of layers (techniques, expected none)");
}

TEST(render_state, is_read_as_it_was_written) {
  RenderState a(Film(2, 1, 1), {64, 3600, 0.01, true});
  a.film.complete({16, 4});
  a.first = 16, a.goal = 32, a.added = 8, a.whole = 64;
  a.seconds = 12.25, a.cpu_seconds = 24.5, a.began = 0.125;
  a.tally.rays = {1, 2, 3, 4};
  a.tally.begin_portals(2);
  a.tally.portals[1].lit = 7;
  a.tally.portals[1].energy.add(0.5);
  a.tally.energy[2].add(0.25);
  a.target.emplace();
  a.target->error = 0.01;
  a.target->fixed = 64;
  ErrorPilot::Round round;
  round.samples = 8;
  round.estimate.lit = true;
  round.estimate.spread = std::numeric_limits<double>::infinity();
  a.pilot.rounds.push_back(round);
  a.blocks.add({{1, 2, 3}, {4, 5, 6}});
  Measured& measured = a.measured.emplace();
  measured.forecast.estimates = {{"bdpt", false, 0.5, 100, std::numeric_limits<double>::infinity()},
                                 {"tdpt", true, 0.25, 200, 50}};
  measured.forecast.best = 1;
  measured.forecast.portals = {{2, 1, 4}, 1, 0};
  measured.pilot_samples = 64, measured.pilot_cpu_seconds = 0.5;
  a.frames = {{1, 0.5, {0.1, 0.2, 0.3}, 1, 2}};
  a.tally.not_finite_at = {{17, 0, 1}};
  FilmFacts facts;
  facts.state = render_state_text(a);
  facts.counts = counts_of(a.tally);
  Film film(2, 1, 1);
  film.merge(a.film);
  const RenderState b = render_state_of({std::move(film), facts, blocks_of(a)}, "c.exr");
  EXPECT_EQ(render_state_text(b), facts.state);
  EXPECT_EQ(counts_of(b.tally), facts.counts);
  EXPECT_EQ(b.blocks.blocks(), a.blocks.blocks());
  EXPECT_EQ(b.blocks.before(), a.blocks.before());
  EXPECT_EQ(b.frames, a.frames);
  EXPECT_EQ(b.tally.not_finite_at, a.tally.not_finite_at);
  EXPECT_EQ(b.next(), 20u);
  EXPECT_EQ(b.spp(), 64u);
  EXPECT_EQ(b.pilot.rounds[0].estimate.spread, std::numeric_limits<double>::infinity());
}

TEST(render_state, that_is_no_beginning_is_refused) {
  FilmFacts facts;
  facts.spp = 8;
  Film gap(1, 1, 1);
  gap.complete({0, 2});
  gap.complete({4, 2});
  EXPECT_EQ(complaint([&] {
              render_state_of({std::move(gap), facts, {}}, "c.exr");
            }),
            "c.exr:film: holds samples 0 to 1 and 4 to 5, which is no beginning to go on from");
  const auto state = [&](const std::string& text) {
    facts.state = text;
    return complaint([&] { render_state_of({Film(1, 1, 1), facts, {}}, "c.exr"); });
  };
  EXPECT_EQ(state("{"), "c.exr:film.state: is no JSON object");
  EXPECT_EQ(state("{}"), "c.exr:film.state.limits: is missing");
}

}  // namespace tdpt::checkpoint_test
