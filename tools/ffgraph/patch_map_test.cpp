#include "tools/ffgraph/patch_map.h"

#include <gtest/gtest.h>

#include "tools/ffgraph/etendue.h"
#include "tools/ffgraph/walks.h"

namespace tdpt::patch_map_test {

// A square of n x n quads at z = 0; neighbours share corners.
Scene sheet(uint32_t n) {
  Scene s;
  s.materials.emplace_back();
  const auto at = [n](uint32_t i) { return 2 * static_cast<float>(i) / static_cast<float>(n) - 1; };
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i) s.positions.push_back({at(i), at(j), 0});
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      s.triangles.push_back({{a, b, d}, 0});
      s.triangles.push_back({{a, d, c}, 0});
    }
  return s;
}

WalkHit random_place(const Scene& s, uint64_t k) {
  Rng rng(4, 0, k);
  const uint32_t t = rng.below(static_cast<uint32_t>(s.triangles.size()));
  const double u = rng.uniform();
  const TriangleShape shape = shape_of(s, t);
  return {2 * t, Vec3f(shape.p0 + shape.e1 * (0.5 * u) + shape.e2 * 0.3)};
}

std::vector<WalkHit> random_places(const Scene& s, size_t n) {
  std::vector<WalkHit> places;
  for (size_t k = 0; k < n; ++k) places.push_back(random_place(s, k));
  return places;
}

TEST(patch_map, many_places_at_once_make_the_patches_of_one_after_the_other) {
  const Scene s = sheet(30);
  PatchMap one(s, {{-1.03, -1.07, -0.1}, 0.04}, surface_components(s)), many = one;
  std::vector<WalkHit> places = random_places(s, 20000);
  PatchMap all = one;
  all.add_all(places);
  for (size_t k = 0; k < places.size(); ++k)
    if (k % 5 != 0)
      one.find_or_add(places[k].face, Vec3d(places[k].position));
    else
      places[k].face = kNoFace;
  many.add_all(places);
  EXPECT_GT(one.size(), 1000u);
  EXPECT_EQ(one.keys(), many.keys());
  // Skipped points matter: with them the patches come in another order.
  EXPECT_NE(one.keys(), all.keys());
}

TEST(fragments, of_many_faces_come_patch_by_patch_and_within_it_face_by_face) {
  const Scene s = sheet(80);  // more faces than one thread clips at a time
  PatchMap map(s, {{-1.03, -1.07, -0.1}, 0.4}, surface_components(s));
  map.add_all(random_places(s, 20000));
  const Fragments fragments(map);
  double area = 0;
  for (size_t k = 0; k < fragments.all().size(); ++k) {
    const auto& f = fragments.all()[k];
    area += f.area;
    if (k == 0) continue;
    const auto& before = fragments.all()[k - 1];
    EXPECT_LT(std::pair(before.patch, before.face), std::pair(f.patch, f.face));
  }
  EXPECT_NEAR(area, 4, 1e-9);
}

// A sheet of 2 m x 2 m; with `ground` another of 200 m, 0.1 m below it.
Scene sheet_on_a_ground(bool ground) {
  Scene s = sheet(30);
  if (!ground) return s;
  const auto first = static_cast<uint32_t>(s.positions.size());
  for (const float y : {-100.0f, 100.0f})
    for (const float x : {-100.0f, 100.0f}) s.positions.push_back({x, y, -0.1f});
  s.triangles.push_back({{first, first + 1, first + 3}, 0});
  s.triangles.push_back({{first, first + 3, first + 2}, 0});
  return s;
}

// Hits all over the sheet, one in `far_one_in` of them on the ground.
Walks walks_on(const Scene& s, size_t far_one_in) {
  const Scene alone = sheet(30);
  Walks walks;
  for (size_t k = 0; k < 20000; ++k) {
    WalkHit p = random_place(alone, k);
    Rng rng(5, 0, k);
    if (k % far_one_in == 0) {
      const double x = rng.uniform();
      const double y = rng.uniform();
      p = {static_cast<uint32_t>(2 * s.triangles.size() - 2),
           Vec3f(Vec3d(200 * x - 100, 200 * y - 100, -0.1))};
    }
    walks.push_back(p);
  }
  return walks;
}

double fine_cell(const GridOfWalks& g) {
  return std::ldexp(g.grid.base_cell, -2 * g.fine.level);
}

TEST(patch_grid, a_wide_ground_does_not_enlarge_the_patches_of_a_room) {
  const Scene alone = sheet_on_a_ground(false), both = sheet_on_a_ground(true);
  const Walks home = walks_on(alone, 20001);
  const GridOfWalks room = grid_for(alone, home, {home}, 24);
  EXPECT_EQ(room.fine.level, 0);
  EXPECT_NEAR(fine_cell(room), std::sqrt(8.0) / 24, 1e-3);
  const Walks few_far = walks_on(both, 100);
  const GridOfWalks with_ground = grid_for(both, few_far, {few_far}, 24);
  EXPECT_GT(with_ground.fine.level, 0);
  EXPECT_NEAR(fine_cell(with_ground), fine_cell(room), 0.25 * fine_cell(room));
  // Twin: if half of the light goes to the ground, the ground matters.
  const Walks half_far = walks_on(both, 2);
  EXPECT_GT(fine_cell(grid_for(both, half_far, {half_far}, 24)), 20 * fine_cell(room));
  // Half as many cells are twice as large.
  EXPECT_DOUBLE_EQ(grid_for(alone, home, {home}, 12).grid.base_cell, 2 * room.grid.base_cell);
  // Either end of the transport suffices: what only the camera sees counts, too.
  EXPECT_GT(fine_cell(grid_for(both, home, {half_far}, 24)), 20 * fine_cell(room));
}

// The median of the cameras' regions decides, as far as half of all together.
TEST(patch_grid, a_second_camera_hardly_enlarges_the_patches) {
  const Scene s = sheet_on_a_ground(true);
  const Walks home = walks_on(sheet_on_a_ground(false), 20001), far = walks_on(s, 2);
  const double wide = fine_cell(grid_for(s, home, {far}, 24));
  EXPECT_NEAR(fine_cell(grid_for(s, home, {home, far}, 24)), 0.5 * wide, 0.01 * wide);
  EXPECT_NEAR(fine_cell(grid_for(s, home, {far, far}, 24)), wide, 0.01 * wide);  // twin
  EXPECT_NEAR(fine_cell(grid_for(s, home, {far, home, far}, 24)), wide, 0.01 * wide);
}

TEST(patch_grid, cells_are_small_about_the_region_and_large_far_away) {
  const Scene s = sheet_on_a_ground(true);
  const Walks walks = walks_on(s, 100);
  const GridOfWalks g = grid_for(s, walks, {walks}, 24);
  PatchMap map(s, g.grid, surface_components(s), g.fine);
  for (const WalkHit& h : walks) map.find_or_add(h.face, Vec3d(h.position));
  for (const PatchKey& key : map.keys()) {
    const double size = std::ldexp(g.grid.base_cell, -2 * key.level);
    const Vec3d low = g.grid.origin + Vec3d(key.cell[0], key.cell[1], key.cell[2]) * size;
    if (std::abs(low.x) < 1 && std::abs(low.y) < 1) {
      EXPECT_EQ(key.level, g.fine.level);
    }
    if (low.x > 60) {
      EXPECT_LT(key.level, g.fine.level);
    }
  }
}

}  // namespace tdpt::patch_map_test
