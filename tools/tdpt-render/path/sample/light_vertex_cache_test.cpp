// Caches of light walks: candidates stand for all vertices, and the expected numbers of connections
// are right.
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

#include <gtest/gtest.h>

#include <set>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::light_vertex_cache_test {

// Walks of so many vertices each, with distinct positions.
std::vector<Walk> walks_of(const std::vector<int>& sizes) {
  std::vector<Walk> walks(sizes.size());
  double place = 1;
  for (size_t w = 0; w < sizes.size(); ++w)
    for (; walks[w].size < sizes[w]; ++walks[w].size) {
      walks[w].make_place();
      walks[w].v[static_cast<size_t>(walks[w].size)].position.x = place++;
    }
  return walks;
}

LightVertexCache cache_of(const std::vector<Walk>& walks) {
  LightVertexCache cache;
  for (const Walk& y : walks) cache.add(y);
  return cache;
}

double brought(const Vertex& v) {
  return v.connectible ? v.position.x * v.position.x : 0;
}

// Contribution of all vertices per sample of a walk.
double of_all(const std::vector<Walk>& walks, bool starts) {
  double sum = 0;
  for (const Walk& y : walks)
    for (int i = starts ? 0 : 1; i < y.size; ++i) sum += brought(y[i]);
  return sum / static_cast<double>(walks.size());
}

// Estimate of it by candidates, relative. `fault`: factor of the number that each stands for.
double told(const std::vector<Walk>& walks, bool starts, double fault = 1) {
  constexpr int kDraws = 20000;
  const LightVertexCache cache = cache_of(walks);
  std::vector<const LightVertex*> drawn;
  double sum = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double times = fault * cache.draw(starts, (i + 0.5) / kDraws, drawn);
    EXPECT_LE(drawn.size(), size_t{LightVertexCache::kCandidates});
    for (const LightVertex* y : drawn) {
      EXPECT_GE(y->index, starts ? 0 : 1);
      EXPECT_TRUE(y->vertex->connectible);
      sum += brought(*y->vertex) / times / kDraws;
    }
  }
  return sum / of_all(walks, starts);
}

TEST(light_vertex_cache, candidates_stand_for_all_vertices) {
  std::vector<Walk> walks = walks_of({4, 1, 9, 2, 0, 7, 3, 12});
  for (const bool starts : {false, true}) {
    EXPECT_NEAR(told(walks, starts), 1, 1e-4);
    EXPECT_GT(std::abs(told(walks, starts, 1.05) - 1), 0.04);  // twin
  }
  for (const size_t w : {2, 5}) walks[w].v[1].connectible = walks[w].v[0].connectible = false;
  for (const bool starts : {false, true}) EXPECT_NEAR(told(walks, starts), 1, 1e-4);
}

TEST(light_vertex_cache, fewer_vertices_than_candidates_are_all_drawn_for_any_u) {
  const std::vector<Walk> walks = walks_of({3, 1, 2, 0});
  const LightVertexCache cache = cache_of(walks);
  std::vector<const LightVertex*> drawn;
  for (const double u : {0.0, 0.5, 1 - 0x1p-53}) {
    EXPECT_EQ(cache.draw(false, u, drawn), 4);  // walks without vertices count, too
    EXPECT_EQ(drawn.size(), 3u);
    EXPECT_EQ(cache.draw(true, u, drawn), 4);
    EXPECT_EQ(drawn.size(), 6u);
  }
  const std::vector<Walk> just = walks_of({9});
  EXPECT_EQ(cache_of(just).draw(false, 0.3, drawn), 1);
  EXPECT_EQ(drawn.size(), size_t{LightVertexCache::kCandidates});
  EXPECT_NEAR(cache_of(just).draw(true, 1 - 0x1p-53, drawn), 8.0 / 9, 1e-12);
  EXPECT_EQ(drawn.size(), size_t{LightVertexCache::kCandidates});
}

TEST(light_vertex_cache, an_empty_one_has_no_candidates) {
  std::vector<const LightVertex*> drawn(3);
  const std::vector<Walk> walks = walks_of({1, 1, 0});
  LightVertexCache cache = cache_of(walks);
  EXPECT_EQ(cache.draw(false, 0.5, drawn), 0);  // none except y_0
  EXPECT_EQ(cache.draw(true, 0.5, drawn), 3);
  EXPECT_EQ(drawn.size(), 2u);
  cache.clear();
  EXPECT_EQ(cache.draw(true, 0.5, drawn), 0);
  EXPECT_TRUE(drawn.empty());
}

// In a closed box of albedo a walks always survive y_1, then with probability a: with at most D - 1
// edges they have 1 + sum_{j <= D-3} a^j vertices after y_0.
double scattered(double albedo, int max_depth) {
  double sum = max_depth > 1;
  for (int j = 0; j <= max_depth - 3; ++j) sum += std::pow(albedo, j);
  return sum;
}

Mixture in_furnace(const Mixture& mixture, float albedo, int max_depth) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  const Vista vista(scene, scene.camera(""), 16, 12, {portal_in_the_furnace()});
  const Mixture expecting = expecting_connections(vista, mixture, max_depth);
  EXPECT_EQ(expecting, expecting_connections(vista, mixture, max_depth));
  EXPECT_EQ(expecting.techniques, mixture.techniques);
  EXPECT_EQ(expecting.segments, mixture.segments);
  return expecting;
}

TEST(expecting_connections, are_those_of_walks_in_the_furnace) {
  constexpr double kCandidates = LightVertexCache::kCandidates;
  EXPECT_EQ(in_furnace(nee.mixture, 0.5f, 6), nee.mixture);  // it does not walk from lights
  // With y_0 only no more than a cache has walks.
  EXPECT_EQ(in_furnace(bdpt.mixture, 0.5f, 1).connected, LightVertexCache::kWalks);
  for (const int depth : {2, 3}) {  // where no walk ends by chance
    const Mixture m = in_furnace(bdpt.mixture, 0.5f, depth);
    EXPECT_NEAR(m.connected, kCandidates / scattered(0.5, depth), 0.02);
    EXPECT_NEAR(m.connected_to_segments, kCandidates / (1 + scattered(0.5, depth)), 0.02);
  }
  for (const float a : {0.5f, 0.8f})
    for (const int depth : {6, kMaxDepth}) {
      const Mixture m = in_furnace(tdpt_org.mixture, a, depth);
      // Mean of 512 walks; the standard deviation of the length is at most sqrt(a) / (1 - a).
      const double error = 5 * std::sqrt(double{a} / 512) / (1 - double{a});
      EXPECT_NEAR(kCandidates / m.connected, scattered(a, depth), error) << a << " " << depth;
      EXPECT_NEAR(kCandidates / m.connected_to_segments, 1 + scattered(a, depth), error);
      // Twins: without a depth limit, and, where 512 walks suffice, one that may end at y_1.
      EXPECT_GT(std::abs(kCandidates / m.connected - (depth == 6 ? 5 : kMaxDepth)), error);
      if (a > 0.5f) continue;
      EXPECT_GT(std::abs(kCandidates / m.connected - (1 + double{a} * (scattered(a, depth) - 1))),
                error);
    }
}

TEST(light_vertex_cache, has_as_many_walks_however_few_samples_make_one) {
  Mixture mixture = bdpt.mixture;
  for (const double share : {1.0, 0.5, 0.25, 0.3, kFewestLightWalks}) {
    mixture.light_walks = share;
    const uint64_t samples = samples_of_cache(mixture);
    EXPECT_EQ(light_walks_of(mixture, samples), uint64_t{LightVertexCache::kWalks}) << share;
    EXPECT_NEAR(static_cast<double>(samples) * share, LightVertexCache::kWalks, share / 2);
  }
  // At the end of a picture: at least one, and at most one per sample.
  EXPECT_EQ(light_walks_of(mixture, 1), 1u);
  EXPECT_EQ(light_walks_of(mixture, 100), 6u);
  EXPECT_EQ(light_walks_of(mixture, 0), 0u);
  EXPECT_EQ(light_walks_of(bdpt.mixture, 7), 7u);
  EXPECT_EQ(light_walks_of(nee.mixture, 16), 0u);
}

TEST(light_vertex_cache, has_each_pixel_of_a_picture_once) {
  for (const uint64_t pixels : {1, 3, 63, 64, 65, 1000, 12288, 57600})
    for (const uint64_t per_cache : {1, 16, 64, 256}) {
      const uint64_t caches = (pixels + per_cache - 1) / per_cache;
      std::vector<int> times(pixels);
      for (uint64_t cache = 0; cache < caches; ++cache)
        for (uint64_t i = 0; i < (pixels - cache + caches - 1) / caches; ++i)
          ++times.at(pixel_of_cache(cache, i, caches, pixels));
      EXPECT_EQ(times, std::vector<int>(pixels, 1)) << pixels << " " << per_cache;
    }
}

// Samples that share a cache are in pixels far apart: in pictures of 128 x 96 pixels in many
// columns.
TEST(light_vertex_cache, has_pixels_in_many_columns) {
  constexpr uint64_t kWidth = 128, kCaches = 192, kPixels = kWidth * 96;
  const auto columns = [](uint64_t (*pixel)(uint64_t, uint64_t, uint64_t, uint64_t)) {
    std::set<uint64_t> all;
    for (uint64_t i = 0; i < kPixels / kCaches; ++i)
      all.insert(pixel(100, i, kCaches, kPixels) % kWidth);
    return all.size();
  };
  EXPECT_GT(columns(pixel_of_cache), 24u);
  // Twin: evenly apart.
  EXPECT_EQ(columns([](uint64_t cache, uint64_t i, uint64_t caches, uint64_t) {
              return cache + i * caches;
            }),
            2u);
}

// A sample that does not keep its segment leaves its place to the next one.
TEST(light_vertex_cache, counts_walks_and_keeps_the_segments_that_are_of_use) {
  const std::vector<Walk> walks = walks_of({4, 0, 2});
  LightVertexCache counted;
  counted.clear(12);
  for (const Walk& y : walks) counted.add(y);
  EXPECT_EQ(counted.walks_per_sample(), 0.25);  // walks without vertices count, too
  LightVertexCache cache;
  for (int round = 0; round < 2; ++round) {
    cache.clear();
    EXPECT_TRUE(cache.segments().empty());
    for (int sample = 0; sample < 5; ++sample) {
      cache.place_for_segment().x = sample;
      if (sample % 2 == 0) cache.keep_segment();
    }
    std::vector<int> kept;
    for (const PortalSegment& segment : cache.segments()) kept.push_back(segment.x);
    EXPECT_EQ(kept, (std::vector{0, 2, 4}));
  }
}

}  // namespace tdpt::light_vertex_cache_test
