#include "tools/ffgraph/patch_map.h"

#include <gtest/gtest.h>

#include "tools/ffgraph/connectivity.h"
#include "tools/ffgraph/fragments.h"

namespace tdpt {
namespace {

// A square of n x n quads at z = 0, corners of neighbours shared.
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

PatchMap::Place random_place(const Scene& s, uint64_t k) {
  Rng rng(4, 0, k);
  const uint32_t t = rng.below(static_cast<uint32_t>(s.triangles.size()));
  const double u = rng.uniform();
  const TriangleShape shape = shape_of(s, t);
  return {2 * t, shape.p0 + shape.e1 * (0.5 * u) + shape.e2 * 0.3};
}

TEST(patch_table, finds_what_was_put_in_and_nothing_else) {
  PatchTable table;
  const auto key = [](uint32_t k) {
    return PatchKey{{static_cast<int32_t>(k % 40) - 20, static_cast<int32_t>(k / 40), -3},
                    static_cast<int32_t>(k % 3),
                    k % 7};
  };
  EXPECT_EQ(table.find(key(0)), kNoPatch);
  for (uint32_t k = 0; k < 5000; ++k) table[key(k)] = k;
  for (uint32_t k = 0; k < 5000; ++k) EXPECT_EQ(table.find(key(k)), k);
  for (uint32_t k = 5000; k < 6000; ++k) EXPECT_EQ(table.find(key(k)), kNoPatch);
  table[key(7)] = 70;
  size_t count = 0, sum = 0;
  table.each([&](const PatchKey&, uint32_t value) { ++count, sum += value; });
  EXPECT_EQ(count, 5000u);
  EXPECT_EQ(sum, 5000u * 4999 / 2 + 63);
}

TEST(patch_map, many_places_at_once_make_the_patches_of_one_after_the_other) {
  const Scene s = sheet(30);
  PatchMap one(s, {{-1.03, -1.07, -0.1}, 0.04}, surface_components(s)), many = one;
  constexpr size_t kPlaces = 20000;
  for (size_t k = 0; k < kPlaces; ++k)
    if (const auto p = random_place(s, k); k % 5 != 0) one.find_or_add(p.face, p.canonical);
  many.add_all(kPlaces, [&](size_t k) {
    return k % 5 != 0 ? std::optional(random_place(s, k)) : std::nullopt;
  });
  EXPECT_GT(one.size(), 1000u);
  EXPECT_EQ(one.keys(), many.keys());
  // The places left out matter: with them the patches come in another order.
  PatchMap all(s, one.grid(), surface_components(s));
  all.add_all(kPlaces, [&](size_t k) { return std::optional(random_place(s, k)); });
  EXPECT_NE(one.keys(), all.keys());
}

TEST(fragments, of_many_faces_come_patch_by_patch_and_within_it_face_by_face) {
  const Scene s = sheet(80);  // more faces than one thread clips at a time
  PatchMap map(s, {{-1.03, -1.07, -0.1}, 0.4}, surface_components(s));
  map.add_all(20000, [&](size_t k) { return std::optional(random_place(s, k)); });
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

TEST(connectivity, the_two_zeros_are_one_place) {
  Scene s = sheet(2);
  for (Triangle& t : s.triangles)
    for (uint32_t& v : t.vertex) {
      Vec3f copy = s.positions[v];
      copy.z = s.positions.size() % 2 ? 0.0f : -0.0f;
      v = static_cast<uint32_t>(s.positions.size());
      s.positions.push_back(copy);
    }
  EXPECT_EQ(surface_components(s), std::vector<uint32_t>(8, 0));
}

}  // namespace
}  // namespace tdpt
