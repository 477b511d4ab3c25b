// What a rendering reports about itself.
#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::stats_test {

RenderResult render_rooms(const Job& settings) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 24, 18, {portal_in_the_hole()});
  return render(vista, tdpt_org, settings);
}

Job with_frames(uint64_t spp) {
  Job settings;
  settings.limits.spp = spp;
  settings.frames = true;
  return settings;
}

TEST(frames, come_each_sample_until_256_and_then_by_sixteenths) {
  std::vector<uint64_t> spp;
  for (uint64_t s = 0; s < 1000; s = next_frame(s)) spp.push_back(s);
  for (uint64_t s = 0; s <= 256; ++s) EXPECT_EQ(spp[s], s);
  EXPECT_EQ(spp[257], 272u);
  EXPECT_EQ(spp[258], 289u);
  EXPECT_LT(spp.size(), 290u);
}

TEST(frames, end_with_the_picture_itself) {
  const RenderResult r = render_rooms(with_frames(280));
  ASSERT_EQ(r.frames.size(), 258u);
  for (size_t i = 0; i + 1 < r.frames.size(); ++i) {
    EXPECT_LT(r.frames[i].spp, r.frames[i + 1].spp);
    EXPECT_LE(r.frames[i].nonzero, r.frames[i + 1].nonzero);
    EXPECT_LE(r.frames[i].seconds, r.frames[i + 1].seconds);
    EXPECT_LE(r.frames[i].cpu_seconds, r.frames[i + 1].cpu_seconds);
  }
  EXPECT_EQ(r.frames[256].spp, 272u);
  EXPECT_EQ(r.frames.back().spp, 280u);
  EXPECT_EQ(r.frames.back().mean, r.mean());
  EXPECT_EQ(r.frames.back().nonzero, r.nonzero());
  EXPECT_GT(r.nonzero(), 0.5);
  EXPECT_LE(r.frames.back().seconds, r.progress->seconds);
  EXPECT_LE(r.frames.back().cpu_seconds, r.progress->cpu_seconds);
}

TEST(frames, are_what_a_shorter_rendering_gives_and_change_no_bit_of_the_picture) {
  const RenderResult r = render_rooms(with_frames(20));
  Job settings;
  settings.limits.spp = 20;
  const RenderResult without = render_rooms(settings);
  EXPECT_EQ(r.picture.pixels, without.picture.pixels);
  EXPECT_TRUE(without.frames.empty());
  settings.limits.spp = 7;
  const RenderResult shorter = render_rooms(settings);
  EXPECT_EQ(r.frames[6].spp, 7u);
  EXPECT_EQ(r.frames[6].mean, shorter.mean());
  EXPECT_EQ(r.frames[6].nonzero, shorter.nonzero());
  EXPECT_NE(r.frames[7].mean, shorter.mean());  // twin: the next one is another picture
}

TEST(frames, stand_in_the_statistics) {
  const Job settings = with_frames(3);
  const RenderResult r = render_rooms(settings);
  const auto stats = stats_of(settings, tdpt_org, {}, r);
  ASSERT_EQ(stats["frames"].size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(stats["frames"][i]["spp"], i + 1);
    EXPECT_EQ(stats["frames"][i]["nonzero"], r.frames[i].nonzero);
    EXPECT_EQ(stats["frames"][i]["mean"][1], r.frames[i].mean.y);
    EXPECT_EQ(stats["frames"][i]["seconds"], r.frames[i].seconds);
    EXPECT_EQ(stats["frames"][i]["cpu_seconds"], r.frames[i].cpu_seconds);
  }
  EXPECT_EQ(stats["mean"], stats["frames"][2]["mean"]);
}

// All walls of the furnace emit radiance 1, seen directly at depth 1. Every other triangle is
// spoilt once the world has been built: whoever sees it gets NaN or infinity.
struct Spoilt {
  Scene scene = read_gltf(furnace_path());
  RenderResult result;

  explicit Spoilt(float emission, int max_depth = 1, const Integrator& integrator = pt) {
    Material material = scene.materials[scene.triangles[0].material];
    scene.materials = {material, material};
    for (size_t i = 0; i < scene.triangles.size(); ++i) scene.triangles[i].material = i % 2;
    const Vista vista(scene, scene.camera(""), width, height, {portal_in_the_furnace()});
    scene.materials[1].emission.y = emission;
    Job settings;
    settings.limits.spp = spp;
    settings.max_depth = max_depth;
    result = render(vista, integrator, settings);
  }

  static constexpr int width = 32, height = 24;
  static constexpr uint64_t spp = 4;
};

TEST(not_finite, is_counted_and_placed_and_left_out_of_the_picture) {
  const Scene furnace = read_gltf(furnace_path());
  const float emission = furnace.materials[furnace.triangles[0].material].emission.x;
  for (const float value : {NAN, INFINITY, 1e30f}) {
    const Spoilt room(value);
    const RenderResult& r = room.result;
    // The samples missing from the pixels give the expected count.
    double missing = 0;
    for (const Rgb& p : r.picture.pixels) {
      EXPECT_TRUE(is_finite(p));
      missing += (1 - p.x / emission) * static_cast<double>(Spoilt::spp);
    }
    EXPECT_GT(r.tally.not_finite, 100u);
    EXPECT_NEAR(static_cast<double>(r.tally.not_finite), missing, 1e-3 * missing);
    ASSERT_EQ(r.tally.not_finite_at.size(), 4u);
    for (const Tally::SamplePixel& place : r.tally.not_finite_at) {
      ASSERT_TRUE(place.x >= 0 && place.x < Spoilt::width);
      ASSERT_TRUE(place.y >= 0 && place.y < Spoilt::height);
      EXPECT_LT(place.sample, Spoilt::spp);
      const auto i = static_cast<size_t>(place.y * Spoilt::width + place.x);
      EXPECT_LT(r.picture.pixels[i].x, 0.99f * emission);
    }
    EXPECT_EQ(stats_of(Job(), pt, {}, r)["not_finite"], r.tally.not_finite);
  }
}

TEST(not_finite, twin_a_sound_scene_has_none) {
  const Spoilt room(1);
  EXPECT_EQ(room.result.tally.not_finite, 0u);
  EXPECT_TRUE(room.result.tally.not_finite_at.empty());
}

TEST(not_finite, never_reaches_the_picture_by_any_technique) {
  for (const Integrator* integrator : integrators()) {
    const Spoilt room(NAN, 5, *integrator);
    EXPECT_GT(room.result.tally.not_finite, 0u) << integrator->name;
    EXPECT_TRUE(std::all_of(room.result.picture.pixels.begin(), room.result.picture.pixels.end(),
                            [](const Rgb& p) { return is_finite(p); }))
        << integrator->name;
    EXPECT_GT(room.result.nonzero(), 0.5) << integrator->name;
  }
}

TEST(integrators, say_which_light_they_miss) {
  Scene scene = read_gltf(furnace_path());
  for (const Integrator* integrator : integrators())
    EXPECT_EQ(light_missed(*integrator, scene), "") << integrator->name;
  scene.lights.emplace_back();
  EXPECT_NE(light_missed(pt, scene), "");
  EXPECT_EQ(light_missed(nee, scene), "");
  EXPECT_EQ(light_missed(tdpt_ref, scene), "");
  scene.materials[0].plain = false;
  scene.materials[0].metallic = 1;
  scene.materials[0].roughness = 0;
  EXPECT_NE(light_missed(nee, scene).find("nee misses"), std::string::npos);
  EXPECT_NE(light_missed(tdpt_ref, scene).find("tdpt misses"), std::string::npos);
  EXPECT_EQ(light_missed(bdpt, scene), "");
  EXPECT_EQ(light_missed(tdpt_org, scene), "");
}

}  // namespace tdpt::stats_test
