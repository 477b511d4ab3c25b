// Pictures of `auto`: independent of the number of threads, and rendered by the right integrator,
// which is chosen from few samples.
#include <cmath>
#include <set>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <nlohmann/json.hpp>

#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/told.h"

namespace tdpt::auto_test {

struct Room {
  Scene scene;
  Vista vista;
  std::vector<Candidate> candidates;

  Room(const std::string& path, const std::vector<Portal>& portals, int width, int height)
      : scene(read_gltf(path)),
        vista(scene, scene.camera(""), width, height, portals),
        candidates(expecting_connections(vista, auto_candidates(vista), kMaxDepth)) {}

  RenderResult render(const Job& settings) const {
    return tdpt::render(vista, candidates, settings);
  }
  Plan plan(const Job& settings) const {
    CpuRenderer cpu(vista);
    Session session(cpu, settings);
    Explored explored;
    explored.lights = vista.openings.selection.shares();
    return make_plan(session, candidates, explored);
  }
};

Room two_rooms(int width = 40, int height = 30) {
  return Room(two_rooms_path(), {portal_in_the_hole()}, width, height);
}
Room window(int width, int height) {
  return Room(TDPT_TESTDATA "/scenes/window.glb",
              {rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0})}, width, height);
}

Job of(uint64_t spp, uint64_t seed = 1) {
  Job settings;
  settings.limits.spp = spp;
  settings.seed = seed;
  return settings;
}

bool says(const std::string& sentence, const char* words) {
  return sentence.find(words) != std::string::npos;
}

TEST(auto_choice,
     and_the_picture_are_the_same_for_any_number_of_threads_and_others_for_another_seed) {
  const Room room = two_rooms();
  const auto rendered = [&](size_t threads, uint64_t seed) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return room.render(of(40, seed));
  };
  const RenderResult one = rendered(1, 1), three = rendered(3, 1), other = rendered(3, 2);
  ASSERT_EQ(one.plan.forecast.estimates.size(), room.candidates.size());
  EXPECT_EQ(one.picture.pixels, three.picture.pixels);
  EXPECT_NE(one.picture.pixels, other.picture.pixels);
  EXPECT_EQ(one.plan.label, three.plan.label);
  for (size_t i = 0; i < room.candidates.size(); ++i) {
    const CandidateEstimate &a = one.plan.forecast.estimates[i],
                            &b = three.plan.forecast.estimates[i];
    EXPECT_EQ(a.relmse, b.relmse);
    EXPECT_EQ(a.work, b.work);
    EXPECT_NE(a.relmse, other.plan.forecast.estimates[i].relmse);
  }
}

// From 8 samples per pixel on where much is at stake, and from 64 on where guided walks cost half
// as much again: until then the portals are taken at their word.
TEST(auto_choice, is_a_portal_integrator_for_a_small_hole_and_none_for_a_wide_window) {
  for (const bool hole : {true, false}) {
    const Room room = hole ? two_rooms(96, 72) : window(64, 48);
    for (uint64_t seed = 1; seed <= 4; ++seed) {
      const Plan plan = room.plan(of(hole ? 8 : 64, seed));
      const Forecast& f = plan.forecast;
      EXPECT_EQ(room.candidates[f.best].with_portals(), hole)
          << plan.label << " for " << (hole ? "the hole" : "the window");
      EXPECT_EQ(f.portals_gain > 3, hole);
      EXPECT_EQ(f.portals_gain < 1, !hole);
      EXPECT_LT(f.gain_low, f.portals_gain);
      EXPECT_GT(f.gain_high, f.portals_gain);
    }
  }
}

// The pilot's samples are thrown away: the picture equals the chosen integrator's, sample by
// sample.
TEST(auto_choice, renders_as_the_chosen_one_does_alone) {
  const Room room = two_rooms();
  const RenderResult r = room.render(of(24));
  EXPECT_GT(r.plan.pilot_samples, 0u);
  EXPECT_EQ(r.spp(), 24u);
  const RenderResult alone =
      render(room.vista, room.candidates[r.plan.forecast.best].integrator, of(24));
  EXPECT_EQ(r.picture.pixels, alone.picture.pixels);
  EXPECT_EQ(r.tally.rays.closest, alone.tally.rays.closest);
}

TEST(auto_choice, uses_the_portals_where_the_samples_are_too_few_to_tell) {
  const Room room = two_rooms(16, 12);
  const RenderResult r = room.render(of(2));
  EXPECT_EQ(r.plan.label, "tdpt-guided");
  EXPECT_TRUE(r.plan.forecast.estimates.empty());
  EXPECT_EQ(r.plan.pilot_samples, 0u);
  EXPECT_TRUE(says(choice_sentence(r), "too few"));
  EXPECT_EQ(verdict_sentence(r), "");
}

TEST(auto_choice, costs_a_small_part_of_the_work) {
  const Room room = two_rooms(64, 48);
  Film film(64, 48, room.vista.world->lights.power());
  Pilot pilot(room.vista, room.candidates, {});
  EXPECT_FALSE(can_spare(4 * 20, pilot));
  EXPECT_TRUE(can_spare(4 * 64 * 48, pilot));
  pilot.draw(kFewestGroups, film);
  const Forecast told = pilot.forecast();
  const double work = told.estimates[told.best].work;
  for (const double spp : {4.0, 8.0, 32.0, 256.0, 1e4, 1e9}) {
    const uint64_t groups = groups_for(spp * 64 * 48, pilot);
    const double share =
        static_cast<double>(groups) * pilot.work_of_group() / (spp * 64 * 48 * work);
    EXPECT_LE(share, 1.5 * kPilotShare);  // of the best candidate's work
    EXPECT_EQ(groups % Pilot::kBatches, 0u);
    EXPECT_LE(groups, kMostGroups);
  }
  EXPECT_EQ(groups_for(1e9 * 64 * 48, pilot), kMostGroups);
}

TEST(auto_choice, by_the_clock_looks_around_in_a_part_of_the_time) {
  const Room room = two_rooms(64, 48);
  Job settings;
  settings.limits.seconds = 1;
  const RenderResult r = room.render(settings);
  EXPECT_GE(r.plan.pilot_samples, kFewestGroups);
  EXPECT_LT(r.plan.pilot_cpu_seconds, 0.5 * r.progress->cpu_seconds);
  EXPECT_GE(r.spp(), 1u);
}

TEST(auto_choice, stands_in_the_statistics) {
  const Room room = two_rooms();
  Job settings = of(20);
  settings.automatic = true;
  const RenderResult r = room.render(settings);
  const Integrator any = either_of(room.candidates);
  const nlohmann::ordered_json j = stats_of(settings, any, {portal_in_the_hole()}, r);
  EXPECT_EQ(j["integrator"], "auto");
  EXPECT_EQ(j["chosen"], r.plan.label);
  EXPECT_EQ(j["pilot"]["samples"], r.plan.pilot_samples);
  EXPECT_EQ(j["pilot"]["portals_gain"], r.plan.forecast.portals_gain);
  ASSERT_EQ(j["pilot"]["candidates"].size(), r.plan.forecast.estimates.size());
  const auto& first = j["pilot"]["candidates"][0];
  EXPECT_EQ(first["integrator"], r.plan.forecast.estimates[0].integrator);
  EXPECT_EQ(first["relmse"], r.plan.forecast.estimates[0].relmse);
  EXPECT_EQ(first["portals"], room.candidates[0].with_portals());
  const nlohmann::ordered_json without = stats_of(of(2), bdpt, {}, render(room.vista, bdpt, of(2)));
  EXPECT_FALSE(without.contains("chosen"));
  EXPECT_FALSE(without.contains("pilot"));
}

TEST(auto_choice, says_what_it_chose_and_why_and_what_portals_are_worth) {
  RenderResult r;
  Forecast& f = r.plan.forecast;
  const auto set_gain = [&](double gain, double low, double high) {
    f.portals_gain = gain, f.gain_low = low, f.gain_high = high;
  };
  r.progress = std::make_shared<Progress>(Film(1, 1, 1), Limits());
  r.plan.pilot_samples = 512;
  r.plan.label = "tdpt-org";
  f.estimates = {{"bdpt", false, 45, 200, 9000}, {"tdpt-org", true, 10, 300, 3000}};
  f.best = 1;
  set_gain(3, 2, 4.5);
  EXPECT_TRUE(says(choice_sentence(r), "bdpt would take 3 times as long"));
  EXPECT_TRUE(says(verdict_sentence(r), "3 times as fast, 2 to 4.5"));
  f.estimates[1].cost = 18000;
  set_gain(0.5, 0.4, 0.62);
  f.best = 0;
  r.plan.label = "bdpt";
  EXPECT_TRUE(says(choice_sentence(r), "tdpt-org would take 2 times as long"));
  EXPECT_TRUE(says(verdict_sentence(r), "portals do not pay"));
  f.estimates[1].cost = 9100;
  EXPECT_TRUE(says(choice_sentence(r), "tdpt-org would do as well"));
  set_gain(0.8, 0.5, 1.1);
  EXPECT_TRUE(says(verdict_sentence(r), "portals probably do not pay"));
  f.estimates[1].cost = INFINITY;
  EXPECT_TRUE(says(choice_sentence(r), "all others miss light"));
  f.estimates.clear();
  r.progress->interrupted = true;
  EXPECT_TRUE(says(choice_sentence(r), "stopped before it could choose"));
}

TEST(candidates, share_no_samples_and_no_names) {
  const Room room = two_rooms();
  EXPECT_EQ(room.candidates[0].label, "tdpt-guided");
  std::set<uint64_t> streams;
  std::set<std::string> labels;
  for (const Candidate& c : room.candidates) {
    streams.insert(c.integrator.stream);
    labels.insert(c.label);
  }
  EXPECT_EQ(streams.size(), 4u);
  EXPECT_EQ(labels.size(), 4u);
  EXPECT_EQ(room.candidates.size(), 4u);
  const Vista without(room.scene, room.scene.camera(""), 16, 12, {});
  for (const Candidate& c : auto_candidates(without)) EXPECT_FALSE(c.with_portals()) << c.label;
}

TEST(candidates, that_miss_light_of_the_scene_are_none) {
  Scene scene = read_gltf(two_rooms_path());
  scene.lights.emplace_back();
  scene.materials[0].plain = false;
  scene.materials[0].metallic = 1;
  scene.materials[0].roughness = 0;
  const Vista vista(scene, scene.camera(""), 16, 12, {});
  std::vector<std::string> labels;
  for (const Candidate& c : auto_candidates(vista)) labels.push_back(c.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"bdpt with few light walks", "bdpt"}));
}

// Estimated errors against pictures: each pixel's variance over many of them.
class Told : public testing::Test {
 protected:
  static constexpr int kWidth = 24, kHeight = 18;

  // [candidate]: the mean of several pilots, since a bright path that one of them meets may be half
  // of its estimate.
  static std::vector<double> told(const Vista& vista, const std::vector<Candidate>& candidates) {
    constexpr uint64_t kPilots = 4;
    Film film(kWidth, kHeight, vista.world->lights.power());
    std::vector<double> errors(candidates.size());
    for (uint64_t seed = 1; seed <= kPilots; ++seed) {
      SampleRules rules;
      rules.seed = seed;
      Pilot pilot(vista, candidates, rules);
      pilot.draw(2048, film);
      const std::vector<CandidateEstimate> estimates = pilot.forecast().estimates;
      for (size_t i = 0; i < errors.size(); ++i) errors[i] += estimates[i].relmse / kPilots;
    }
    return errors;
  }
};

TEST_F(Told, errors_are_those_of_pictures) {
  const Room room = two_rooms(kWidth, kHeight);
  const std::vector<double> errors = told(room.vista, room.candidates);
  std::vector<double> pictures;
  for (size_t i = 0; i < errors.size(); ++i) {
    pictures.push_back(error_of_pictures(room.vista, room.candidates[i].integrator));
    std::printf("%-28s told %8.4f  of pictures %8.4f\n", room.candidates[i].label.c_str(),
                errors[i], pictures[i]);
    // Stratified samples make pictures better than one sample predicts, low-noise pictures most.
    EXPECT_GT(pictures[i], 0.5 * errors[i]) << room.candidates[i].label;
    EXPECT_LT(pictures[i], 1.3 * errors[i]) << room.candidates[i].label;
  }
  // Twin: the errors of another candidate do not match.
  for (size_t i = 1; i < errors.size(); ++i)
    if (room.candidates[i].label == "nee" || room.candidates[i].label == "tdpt-org") {
      EXPECT_FALSE(pictures[i] > 0.5 * errors[0] && pictures[i] < 1.3 * errors[0]);
    }
}

TEST_F(Told, of_a_scene_without_light_nothing) {
  Scene scene = read_gltf(two_rooms_path());
  for (Material& m : scene.materials) m.emission = {};
  const Vista vista(scene, scene.camera(""), kWidth, kHeight, {portal_in_the_hole()});
  const std::vector<Candidate> candidates = auto_candidates(vista);
  for (const double e : told(vista, candidates)) EXPECT_EQ(e, 0);
}

}  // namespace tdpt::auto_test
