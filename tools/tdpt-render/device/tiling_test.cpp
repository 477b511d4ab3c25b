// A picture is byte-identical however it is divided into submissions and calls.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/testing/device.h"
#include "tools/tdpt-render/testing/stages.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::tiling_test {

// Room for one cache at a time, and less where paths are long.
const std::vector<Capacity> kRooms{{1u << 13, kMostOfCache}, {1u << 14, 777}, {1u << 15, 1u << 14}};

void expect_same_in_all_rooms(const Stage& stage, int width, int height, const Samples& samples) {
  const Vista vista = stage.vista(width, height);
  ScalarRenderer large(vista);
  for (const Integrator* integrator : integrators()) {
    const Outcome whole = rendered_by(large, vista, *integrator, samples);
    for (const Capacity& room : kRooms) {
      ScalarRenderer small(vista, room);
      EXPECT_EQ(whole, rendered_by(small, vista, *integrator, samples))
          << stage.name << " " << integrator->name << " " << room.vertices;
    }
  }
}

TEST(tiling, in_any_room_is_the_same) {
  expect_same_in_all_rooms(two_rooms_stage(), 33, 17, {{0, 3}, {8}, false, true, true});
  expect_same_in_all_rooms(everything_stage(), 33, 17, {{5, 2}, {6}, true, true, true});
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {1, 300}, {16, 1}})
    expect_same_in_all_rooms(two_rooms_stage(), width, height, {{0, 5}, {4}});
}

// A submission that is halved on the way: there is room for the walks of many samples at first, and
// rays that were counted must be taken back.
TEST(tiling, walks_that_have_no_room_leave_nothing_behind) {
  const Stage stage{"furnace", read_gltf(furnace_path()), {portal_in_the_furnace()}};
  const Vista vista = stage.vista(24, 18);
  const Samples samples{{0, 4}, {64, 2, 3}, true};
  for (const Integrator* integrator : integrators()) {
    ScalarRenderer large(vista, {1u << 19, 1u << 14}), small(vista, {1u << 13, 1u << 11});
    EXPECT_EQ(rendered_by(large, vista, *integrator, samples),
              rendered_by(small, vista, *integrator, samples))
        << integrator->name;
  }
}

// Samples split over several calls, as shards and checkpoints do.
TEST(tiling, in_any_calls_is_the_same) {
  const Stage stage = sky_stage();
  const Vista vista = stage.vista(33, 17);
  ScalarRenderer scalar(vista);
  for (const Integrator* integrator : {&nee, &bdpt, &tdpt_guided}) {
    Integrator expecting = *integrator;
    expecting.mixture = expecting_connections(vista, integrator->mixture, 5);
    Film film = film_for(vista, TechniqueSet(), true, true);
    Tally tally(film.unit());
    ProgressBar progress("rendering", "samples", 0, true);
    for (const SampleRange range : {SampleRange{2, 1}, {0, 2}, {3, 3}})
      scalar.render(expecting, {5}, 0, range, film, tally, progress);
    EXPECT_EQ(rendered_by(scalar, vista, *integrator, {{0, 6}, {5}, true, false, true}),
              outcome_of(film, tally))
        << integrator->name;
  }
}

// Twin: other samples make another picture.
TEST(tiling, twin_other_samples_are_seen) {
  const Stage stage = two_rooms_stage();
  const Vista vista = stage.vista(7, 5);
  ScalarRenderer scalar(vista);
  const Outcome one = rendered_by(scalar, vista, bdpt, {{0, 2}, {8}});
  EXPECT_EQ(one, rendered_by(scalar, vista, bdpt, {{0, 2}, {8}}));
  EXPECT_NE(one, rendered_by(scalar, vista, bdpt, {{1, 2}, {8}}));
  EXPECT_NE(one, rendered_by(scalar, vista, bdpt, {{0, 2}, {8, 1, 2}}));
  EXPECT_NE(one, rendered_by(scalar, vista, bdpt, {{0, 2}, {7}}));
  EXPECT_NE(one, rendered_by(scalar, vista, bdpt, {{0, 2}, {8, 2}}));
}

// A lamp brighter than films can hold; the CPU reports the places of the same samples.
TEST(tiling, what_is_left_out_has_the_places_that_the_cpu_names) {
  Stage stage{"furnace", read_gltf(furnace_path()), {}};
  Material lamp = stage.scene.materials[0];
  stage.scene.materials = {lamp, lamp};
  for (size_t i = 0; i < stage.scene.triangles.size(); ++i)
    stage.scene.triangles[i].material = i % 2;
  const Vista vista = stage.vista(33, 17);
  stage.scene.materials[1].emission = Rgb(1e30f);
  CpuRenderer cpu(vista);
  for (const SampleRange& range : {SampleRange{0, 3}, {(uint64_t{1} << 32) - 1, 2}}) {
    const Samples samples{range, {1}};
    const Outcome known = rendered_by(cpu, vista, pt, samples);
    ASSERT_EQ(known.not_finite_at.size(), Tally::kMostPlaces);
    for (const Capacity& room : kRooms) {
      ScalarRenderer scalar(vista, room);
      const Outcome found = rendered_by(scalar, vista, pt, samples);
      EXPECT_EQ(found.not_finite_at, known.not_finite_at);
      EXPECT_EQ(found.counts[4], known.counts[4]);  // their number
    }
  }
}

TEST(tiling, a_cache_that_has_no_room_is_refused_with_both_numbers) {
  const Stage stage{"furnace", read_gltf(furnace_path()), {}};
  const Vista vista = stage.vista(16, 16);
  ScalarRenderer scalar(vista, {100, kMostOfCache});
  try {
    rendered_by(scalar, vista, bdpt, {{0, 1}, {64}});
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::no_device);
    EXPECT_NE(std::string(e.what()).find("room for 100 vertices"), std::string::npos);
  }
}

}  // namespace tdpt::tiling_test
