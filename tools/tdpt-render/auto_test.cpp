// Pictures of `auto`: the same for any number of threads, unbiased though its samples are kept, and
// made by the right integrator.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <nlohmann/json.hpp>

#include "libcommon/testing/z_failure.h"
#include "tools/tdpt-render/portal_probe.h"
#include "tools/tdpt-render/report.h"
#include "tools/tdpt-render/test_rooms.h"

namespace tdpt {
namespace {

struct Room {
  Scene scene;
  std::vector<Portal> portals;
  World world;

  Room(const std::string& path, const Portal& portal, int width, int height)
      : scene(read_gltf(path)),
        portals{portal},
        world(scene, scene.camera(""), width, height, portals) {
    probe(world, portals);
  }
  std::vector<Candidate> candidates() const { return auto_candidates(world, portals); }
};

Room two_rooms(int width = 40, int height = 30) {
  return Room(two_rooms_path(), portal_in_the_hole(), width, height);
}
Room window(int width, int height) {
  return Room(TDPT_TESTDATA "/scenes/window.glb",
              rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0}), width, height);
}

RenderSettings of(uint64_t spp, uint64_t seed = 1) {
  RenderSettings settings;
  settings.spp = spp;
  settings.seed = seed;
  return settings;
}

TEST(auto_choice, is_the_same_and_so_is_the_picture_for_any_number_of_threads) {
  const Room room = two_rooms();
  RenderSettings settings = of(70);
  settings.layers = true;
  std::vector<RenderResult> results;
  for (size_t threads : {1, 2, 3}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(render(room.world, room.candidates(), settings));
  }
  ASSERT_EQ(results[0].pilot.size(), 4u);
  for (size_t r : {1, 2}) {
    EXPECT_EQ(results[0].picture.pixels, results[r].picture.pixels);
    EXPECT_EQ(results[0].chosen_label, results[r].chosen_label);
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(results[0].pilot[i].relmse, results[r].pilot[i].relmse);
      EXPECT_EQ(results[0].pilot[i].work, results[r].pilot[i].work);
    }
    for (const auto& [name, layer] : results[0].layers)
      EXPECT_EQ(layer.pixels, results[r].layers.at(name).pixels) << name;
  }
}

TEST(auto_choice, twin_another_seed_gives_another_picture) {
  const Room room = two_rooms();
  EXPECT_NE(render(room.world, room.candidates(), of(40, 1)).picture.pixels,
            render(room.world, room.candidates(), of(40, 2)).picture.pixels);
}

TEST(auto_choice, is_a_portal_integrator_for_a_small_hole_and_none_for_a_wide_window) {
  for (const bool hole : {true, false}) {
    const Room room = hole ? two_rooms(80, 60) : window(80, 60);
    for (uint64_t seed : {1, 2}) {
      const RenderResult r = render(room.world, room.candidates(), of(64, seed));
      ASSERT_EQ(r.pilot.size(), 4u);
      EXPECT_EQ(room.candidates()[r.chosen].integrator.mixture.has(Technique::portal), hole)
          << r.chosen_label << " for " << (hole ? "the hole" : "the window");
    }
  }
}

// In 48 pixels two samples each tell nothing: pt, which met no light in them, looked perfect.
TEST(auto_choice, in_a_small_picture_gives_no_candidate_up_for_a_few_samples) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 8, 6, {});
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const RenderResult r = render(world, auto_candidates(world, {}, {}), of(1100, seed));
    ASSERT_EQ(r.pilot.size(), 3u);
    for (const PilotRecord& record : r.pilot) {
      EXPECT_GE(static_cast<double>(record.spp) * 48, kLeastSamples) << record.integrator;
      EXPECT_GT(record.relmse, 1) << record.integrator;
    }
  }
}

TEST(auto_choice, all_samples_are_counted_and_all_shares_add_up) {
  const Room room = two_rooms();
  const RenderResult r = render(room.world, room.candidates(), of(64));
  EXPECT_EQ(r.spp, 64u);
  double share = 0;
  for (const PilotRecord& record : r.pilot) {
    EXPECT_GE(record.spp, 2u);
    EXPECT_GT(record.work, 100);
    EXPECT_GT(record.relmse, 0);
    share += record.share;
  }
  EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_GT(r.pilot[r.chosen].share, 0.8);
}

// What comes after the pilot is the chosen one's picture, sample by sample.
TEST(auto_choice, renders_the_rest_as_the_chosen_one_does_alone) {
  const Room room = two_rooms();
  RenderSettings settings = of(64);
  settings.pilot = PilotPlan{4, 2, 0};
  const RenderResult r = render(room.world, room.candidates(), settings);
  uint64_t left = 64;
  for (const PilotRecord& record : r.pilot) left -= record.spp;
  EXPECT_LE(left, 50u);
  EXPECT_EQ(r.picture.pixels,
            render(room.world, room.candidates()[r.chosen].integrator, of(left)).picture.pixels);
}

TEST(auto_choice, without_a_pilot_is_the_first_candidate) {
  const Room room = two_rooms();
  const RenderResult r = render(room.world, room.candidates(), of(20));
  EXPECT_EQ(r.chosen_label, "tdpt-guided 0.5 0.4 1");
  EXPECT_TRUE(r.pilot.empty());
  EXPECT_EQ(r.picture.pixels, render(room.world, tdpt_guided, of(20)).picture.pixels);
}

TEST(auto_choice, layers_add_up_to_the_picture) {
  const Room room = two_rooms();
  RenderSettings settings = of(64);
  settings.layers = true;
  const RenderResult r = render(room.world, room.candidates(), settings);
  EXPECT_EQ(r.layers.size(), size_t{kTechniques});
  EXPECT_EQ(render(room.world, room.candidates(), of(64)).picture.pixels, r.picture.pixels);
  double total = 0;
  for (size_t i = 0; i < r.picture.pixels.size(); ++i) {
    Vec3d sum;
    for (const auto& [name, layer] : r.layers) sum += Vec3d(layer.pixels[i]);
    EXPECT_NEAR(sum.y, r.picture.pixels[i].y, 1e-5 * sum.y);
    total += luminance(r.picture.pixels[i]);
  }
  // And the techniques' shares of the energy are those of the layers.
  double energy = 0;
  for (double e : r.tally.energy) energy += e;
  for (size_t t = 0; t < kTechniques; ++t) {
    double of_layer = 0;
    for (const Rgb& p : r.layers.at(kTechniqueNames[t]).pixels) of_layer += luminance(p);
    EXPECT_NEAR(r.tally.energy[t] / energy, of_layer / total, 1e-4) << kTechniqueNames[t];
  }
}

TEST(auto_choice, frames_begin_after_the_pilot_and_end_with_the_picture) {
  const Room room = two_rooms(40, 30);
  RenderSettings settings = of(64);
  settings.frames = true;
  const RenderResult r = render(room.world, room.candidates(), settings);
  uint64_t pilot = 0;
  for (const PilotRecord& record : r.pilot) pilot += record.spp;
  ASSERT_EQ(r.frames.size(), 64 - pilot);
  EXPECT_EQ(r.frames.front().spp, pilot + 1);
  EXPECT_EQ(r.frames.back().spp, 64u);
  EXPECT_EQ(r.frames.back().mean, r.mean());
  EXPECT_EQ(r.frames.back().nonzero, r.nonzero());
  EXPECT_EQ(render(room.world, room.candidates(), of(64)).picture.pixels, r.picture.pixels);
}

TEST(auto_choice, stands_in_the_statistics) {
  const Room room = two_rooms();
  const RenderSettings settings = of(64);
  const RenderResult r = render(room.world, room.candidates(), settings);
  const Integrator any = either_of(room.candidates());
  const auto j = nlohmann::json::parse(stats_json(any, settings, r, room.portals));
  EXPECT_EQ(j["integrator"], "auto");
  EXPECT_EQ(j["chosen"], r.chosen_label);
  ASSERT_EQ(j["pilot"].size(), 4u);
  EXPECT_EQ(j["pilot"][1]["integrator"], "bdpt");
  EXPECT_EQ(j["pilot"][1]["spp"], r.pilot[1].spp);
  EXPECT_EQ(j["pilot"][1]["relmse"], r.pilot[1].relmse);
  EXPECT_EQ(j["pilot"][1]["work"], r.pilot[1].work);
  EXPECT_EQ(j["pilot"][1]["share"], r.pilot[1].share);
  EXPECT_EQ(j["techniques"].size(), size_t{kTechniques});
  const RenderResult plain = render(room.world, bdpt, of(2));
  const auto without = nlohmann::json::parse(stats_json(bdpt, settings, plain, room.portals));
  EXPECT_FALSE(without.contains("chosen"));
  EXPECT_FALSE(without.contains("pilot"));
}

TEST(auto_choice, says_what_it_chose_and_why) {
  RenderResult r;
  r.chosen_label = "tdpt-org";
  r.pilot = {{"tdpt-org", 4, 10, 300, 0.9}, {"bdpt", 4, 45, 200, 0.1}};
  EXPECT_EQ(choice_sentence(r, {}),
            "auto chose tdpt-org: error x work is 3 x by bdpt in a pilot of 8 samples per pixel");
  for (PilotRecord& record : r.pilot) record.relmse = 0;
  EXPECT_EQ(choice_sentence(r, {}),
            "auto chose tdpt-org: its samples showed no error in a pilot of 8 samples per pixel");
  r.pilot.clear();
  Portal portal = portal_in_the_hole();
  portal.figures = {{"flux_share", 1}, {"expected_gain", 3}};
  EXPECT_EQ(choice_sentence(r, {portal}),
            "auto chose tdpt-org, as the portals promise a gain; the samples are too few for a "
            "pilot");
  r.chosen_label = "bdpt";
  r.interrupted = true;
  portal.figures["expected_gain"] = 0.8;
  EXPECT_EQ(choice_sentence(r, {portal}),
            "auto chose bdpt, as no portal promises a gain; it was stopped before a pilot could "
            "tell");
}

// Unbiased. The picture is the pilot's alone (kept = 1): nothing of it hides behind the samples of
// the chosen one. Pictures of few pixels know little about errors, so that weights swing widely:
// what would be wrong with them shows.

constexpr int kWidth = 8, kHeight = 6;
constexpr size_t kSeeds = 160;
constexpr uint64_t kRounds = 3;

std::vector<double> luminances(const Picture& picture, double factor = 1) {
  std::vector<double> l;
  for (const Rgb& p : picture.pixels) l.push_back(factor * luminance(p));
  return l;
}

testing::BlockRuns truth(const World& world, const Integrator& integrator) {
  testing::BlockRuns runs;
  for (size_t s = 0; s < 24; ++s)
    runs.add(luminances(render(world, integrator, of(512, 1000 + s)).picture));
  return runs;
}

RenderSettings pilot_alone(uint64_t seed, size_t candidates) {
  RenderSettings settings = of(2 * kRounds * candidates + 1, seed);
  settings.pilot = PilotPlan{candidates, kRounds, 1};
  return settings;
}

TEST(auto_unbiased, the_pilots_picture_agrees_with_bdpt) {
  const Room room = window(kWidth, kHeight);
  const std::vector<Candidate> all = room.candidates();
  const testing::BlockRuns reference = truth(room.world, bdpt);
  testing::BlockRuns pilots, wholes, faulty;
  for (size_t s = 0; s < kSeeds; ++s) {
    const Picture p = render(room.world, all, pilot_alone(s, all.size())).picture;
    pilots.add(luminances(p));
    faulty.add(luminances(p, 0.95));
    RenderSettings whole = of(40, s);
    whole.pilot = PilotPlan{all.size(), 2, 0.1};
    wholes.add(luminances(render(room.world, all, whole).picture));
  }
  for (const auto* runs : {&pilots, &wholes}) {
    const testing::Agreement agreement = testing::compare(*runs, reference);
    std::printf("%s  %s\n", runs == &pilots ? "pilot" : "whole", agreement.text().c_str());
    EXPECT_TRUE(
        testing::holds(agreement, runs == &pilots ? "pilot" : "whole", *runs, reference, kWidth));
  }
  EXPECT_FALSE(testing::compare(faulty, reference).holds());  // twin: 5 % too dark
}

// The same with weights from the very samples that they weigh. Where light is rare it is far too
// dark, and caught; with weights from the rounds before it is not.
testing::BlockRuns weighed_by_themselves(const World& world, const std::vector<Candidate>& all) {
  testing::BlockRuns runs;
  for (size_t s = 0; s < kSeeds; ++s) {
    std::vector<double> picture(size_t{kWidth} * kHeight);
    for (uint64_t round = 0; round < kRounds; ++round) {
      PilotErrors errors(kWidth, kHeight, all.size());
      std::vector<std::vector<double>> means;
      for (size_t i = 0; i < all.size(); ++i) {
        std::array<std::vector<Vec3d>, 2> passes;
        std::vector<double> mean(picture.size());
        for (uint64_t half = 0; half < 2; ++half) {
          const uint64_t seed = 1 + (s * kRounds + round) * 2 + half;
          const Picture p = render(world, all[i].integrator, of(1, seed)).picture;
          for (size_t k = 0; k < mean.size(); ++k) {
            passes[half].emplace_back(p.pixels[k]);
            mean[k] += 0.5 * luminance(p.pixels[k]);
          }
        }
        errors.add_round(i, passes[0], passes[1]);
        means.push_back(mean);
      }
      const std::vector<double> w =
          pilot_weights(errors.relmse(), std::vector<bool>(all.size(), false));
      for (size_t i = 0; i < all.size(); ++i)
        for (size_t k = 0; k < picture.size(); ++k)
          picture[k] += w[i] * means[i][k] / static_cast<double>(kRounds);
    }
    runs.add(picture);
  }
  return runs;
}

TEST(auto_unbiased, twin_weights_from_the_same_round_are_caught) {
  const Room room = two_rooms(kWidth, kHeight);
  const std::vector<Candidate> all = room.candidates();
  const testing::BlockRuns reference = truth(room.world, tdpt_org);
  testing::BlockRuns pilots;
  for (size_t s = 0; s < kSeeds; ++s)
    pilots.add(luminances(render(room.world, all, pilot_alone(s, all.size())).picture));
  const testing::Agreement right = testing::compare(pilots, reference);
  const testing::Agreement wrong =
      testing::compare(weighed_by_themselves(room.world, all), reference);
  std::printf("rounds before  %s\nsame round     %s\n", right.text().c_str(), wrong.text().c_str());
  EXPECT_TRUE(testing::holds(right, "rounds before", pilots, reference, kWidth));
  EXPECT_FALSE(wrong.holds()) << wrong.text();
}

}  // namespace
}  // namespace tdpt
