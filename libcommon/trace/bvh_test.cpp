// The BVH builder; rays are tested in traversal_test.cpp.
#include "libcommon/trace/bvh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "libcommon/testing/scalar_tracer.h"
#include "libcommon/testing/scenes/meshes.h"

namespace tdpt::bvh_test {

using namespace testing;
using shader::BvhNode;
using shader::ScalarTracer;
using shader::SurfaceHit;

struct Structure {
  uint32_t depth = 0;            ///< depth of the deepest leaf in nodes
  uint32_t wrong_nodes = 0;      ///< whose box does not contain their contents
  uint32_t wrong_triangles = 0;  ///< of the scene, that are not in exactly one leaf
};
Structure structure_of(const Bvh& bvh, const Scene& scene) {
  Structure s;
  std::vector<uint32_t> seen(scene.triangles.size());
  struct Entry {
    uint32_t child;
    Vec3f low, high;
    uint32_t depth;
  };
  const Vec3f all(std::numeric_limits<float>::infinity());
  std::vector<Entry> stack{{0, -all, all, 0}};
  const auto inside = [](const Vec3f& low, const Vec3f& high, const Entry& e) {
    return min(low, e.low) == e.low && max(high, e.high) == e.high;
  };
  while (!stack.empty()) {
    const Entry e = stack.back();
    stack.pop_back();
    if ((e.child & shader::kBvhLeaf) != 0) {
      const uint32_t first = e.child & shader::kBvhFirstMask;
      const uint32_t count = (e.child >> shader::kBvhCountShift) & shader::kBvhCountMask;
      for (uint32_t i = first; i < first + count; ++i) {
        const shader::BvhTriangle& t = bvh.triangles.at(i);
        const Vec3f pad(0x1p-19f * bvh.nodes[0].extent);
        s.wrong_nodes +=
            !inside(min(min(t.p0, t.p1), t.p2) - pad, max(max(t.p0, t.p1), t.p2) + pad, e);
        if (t.p0 == scene.vertex(t.triangle, 0) && t.p1 == scene.vertex(t.triangle, 1) &&
            t.p2 == scene.vertex(t.triangle, 2))
          ++seen.at(t.triangle);
      }
    } else {
      const BvhNode& n = bvh.nodes.at(e.child);
      s.depth = std::max(s.depth, e.depth + 1);
      const auto empty = [](uint32_t child) { return child == shader::kBvhLeaf; };
      s.wrong_nodes +=
          !inside(n.low0, n.high0, e) + !(empty(n.child1) || inside(n.low1, n.high1, e));
      stack.push_back({n.child0, n.low0, n.high0, e.depth + 1});
      stack.push_back({n.child1, n.low1, n.high1, e.depth + 1});
    }
  }
  for (uint32_t n : seen) s.wrong_triangles += n != 1;
  return s;
}
void expect_sound(const Scene& scene) {
  const Structure s = structure_of(build_bvh(scene), scene);
  EXPECT_LE(s.depth, shader::kBvhStack);
  EXPECT_EQ(s.wrong_nodes, 0u);
  EXPECT_EQ(s.wrong_triangles, 0u);
}

/// Triangles along the three axes, each nearer to the origin by `factor` than the one before.
Scene dwindling(uint32_t count, double factor) {
  Scene scene = no_triangles();
  for (int axis = 0; axis < 3; ++axis) {
    double size = 1;
    for (uint32_t i = 0; i < count; ++i, size *= factor) {
      Vec3f a;
      a[axis] = static_cast<float>(size);
      add(scene, a, a * 0.99f, a * 0.98f);
    }
  }
  return scene;
}

TEST(bvh, holds_every_triangle_once) {
  for (uint32_t n : {0u, 1u, 2u, 3u, 4u, 5u, 9u, 1000u, 70000u}) expect_sound(soup(n, 0.01));
  expect_sound(file("three-rooms.glb"));
  Scene scene = soup(1000, 0.1);
  Bvh bvh = build_bvh(scene);
  bvh.nodes[3].high0.x -= 0.1f;  // twins
  bvh.triangles[7] = bvh.triangles[8];
  EXPECT_GT(structure_of(bvh, scene).wrong_nodes, 0u);
  EXPECT_EQ(structure_of(bvh, scene).wrong_triangles, 2u);
}

TEST(bvh, no_input_goes_deeper_than_the_stack) {
  uint32_t deepest = 0;
  for (double factor : {0.9, 0.7, 0.5, 0.3, 0.1, 0.03}) {
    const Scene scene = dwindling(1000, factor);
    expect_sound(scene);
    deepest = std::max(deepest, structure_of(build_bvh(scene), scene).depth);
  }
  EXPECT_GT(deepest, 40u);  // else these inputs do not test the bound
}

TEST(bvh, odd_coordinates_build) {
  Scene flat = no_triangles(), line = no_triangles(), huge = no_triangles();
  Rng rng(12, 0, 0);
  for (int i = 0; i < 5000; ++i) {
    const auto x = static_cast<float>(rng.uniform());
    add(flat, {x, 0.5f, 0}, {x + 0.01f, 0.5f, 0}, {x, 0.5f, 0.01f});
    add(line, {x, 0, 0}, {x, 0, 0}, {x, 0, 0});
    const float sign = i % 2 == 0 ? 1e38f : -3.4e38f;
    add(huge, {sign * x, 3.4e38f, 0}, {-3.4e38f, sign, 1e-45f}, {x, 0, sign});
  }
  for (const Scene* scene : {&flat, &line, &huge}) {
    expect_sound(*scene);
    const Bvh bvh = build_bvh(*scene);
    const ScalarTracer tracer(bvh);
    SurfaceHit hit;
    for (int i = 0; i < 100; ++i) {
      tracer.first_hit(Vec3f(random_place(rng, 1)), Vec3f(random_direction(rng)), 0, hit);
      tracer.segment_blocked(Vec3f(random_place(rng, 1)), Vec3f(random_place(rng, 1)), 0);
    }
  }
}

TEST(bvh, a_million_copies_of_one_triangle) {
  Scene scene = no_triangles();
  add(scene, {-1, -1, 0.5f}, {1, -1, 0.5f}, {0, 1, 0.5f});
  scene.triangles.resize(1000000, scene.triangles[0]);
  expect_sound(scene);
  const Bvh bvh = build_bvh(scene);
  SurfaceHit hit;
  ASSERT_TRUE(ScalarTracer(bvh).first_hit({0, 0, 0}, {0.1f, 0.1f, 1}, 0, hit));
  EXPECT_EQ(hit.triangle, 0u);
  EXPECT_FLOAT_EQ(hit.t, 0.5f);
  EXPECT_TRUE(ScalarTracer(bvh).segment_blocked({0, 0, 0}, {0, 0, 1}, 0));
}

template <class T>
std::string bytes_of(const std::vector<T>& v) {
  return {reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T)};
}
TEST(bvh, threads_leave_no_trace) {
  const Scene scene = sphere(300, 0.9);
  const auto built = [&](const Scene& s, size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Bvh bvh = build_bvh(s);
    return bytes_of(bvh.nodes) + bytes_of(bvh.triangles);
  };
  const std::string one = built(scene, 1);
  EXPECT_TRUE(one == built(scene, 3));
  EXPECT_TRUE(one == built(scene, 3));
  EXPECT_FALSE(one == built(sphere(300, 0.9000001), 3));
}

TEST(bvh, surfaces_that_are_not_always_there_are_marked) {
  Scene scene = soup(4, 0.1);
  scene.materials.resize(4);
  scene.materials[1].alpha_mode = Material::Alpha::mask;
  scene.materials[2].alpha_mode = Material::Alpha::blend;
  scene.materials[3].transmission = 1;  // a smooth thin sheet: a pane
  scene.materials[3].roughness = 0;
  scene.materials[3].base_color = Rgb(1);
  for (uint32_t t = 0; t < 4; ++t) scene.triangles[t].material = t;
  for (const shader::BvhTriangle& t : build_bvh(scene).triangles)
    EXPECT_EQ(t.stops, t.triangle == 0 ? 1u : 0u) << t.triangle;
}

}  // namespace tdpt::bvh_test
