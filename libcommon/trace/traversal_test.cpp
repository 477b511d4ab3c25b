// Hierarchies from bvh.h, and the rays that shaders/shared/traversal.h and bvh.h, compiled as C++,
// trace in them.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "libcommon/math/rng.h"
#include "libcommon/testing/scalar_tracer.h"
#include "libcommon/testing/scenes/meshes.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::shader::traversal_test {

/// Surfaces with partial coverage are present for every second coin.
struct ScreenTracer : ScalarTracer {
  using ScalarTracer::ScalarTracer;
  bool surface_stops(uint triangle, float, float, uint coin, const vec3&) const {
    return ((triangle + coin) & 1) != 0;
  }

#include "shaders/shared/traversal.h"
};

}  // namespace tdpt::shader::traversal_test

namespace tdpt::traversal_test {

using namespace testing;
using shader::BvhNode;
using shader::ScalarTracer;
using shader::SurfaceHit;

// --- As Embree ---------------------------------------------------------------------------------

struct Compared {
  int rays = 0, hits = 0, blocked = 0, differ = 0;
};
/// The first hits of rays and what blocks segments, from one place to another: each anywhere within
/// `size`, far outside, or on a triangle, offset as Tracer does; some rays are parallel to an axis.
/// Two hits are the same within the blur of floats, sideways and along.
Compared against_embree(const Scene& scene, const Bvh& bvh, int rays, double size = 1) {
  const Tracer embree(scene);
  const ScalarTracer tracer(bvh);
  const auto triangles = static_cast<uint32_t>(scene.triangles.size());
  Compared c;
  for (int i = 0; i < rays; ++i) {
    Rng rng(13, 0, static_cast<uint64_t>(i));
    const auto place = [&](uint32_t kind) {
      if (kind == 0 || triangles == 0) return Vec3f(random_place(rng, size));
      if (kind == 1) return Vec3f(random_direction(rng) * (8 * size));
      const TriangleShape& s = embree.shape(rng.below(triangles));
      double b1, b2;
      const double u = rng.uniform();
      uniform_triangle(u, rng.uniform(), b1, b2);
      const double side = rng.below(2) == 0 ? -0x1p-21 : 0x1p-21;
      return Vec3f(s.p0 + s.e1 * b1 + s.e2 * b2 + s.normal * (side * size));
    };
    const uint32_t from = rng.below(3);
    const Vec3f o = place(from);
    // From far outside, rounding moves an end across a triangle that it lies on.
    Vec3f d = place(from == 1 ? 0 : rng.below(3)) - o;
    if (i % 8 == 0) d[i / 8 % 3] = d[(i / 8 + 1) % 3] = i % 16 == 0 ? 0 : 1e-30f;
    SurfaceHit ours, theirs;
    const bool found = tracer.first_hit(o, d, 0, ours);
    bool differs = found != embree.first_hit(o, d, 0, theirs);
    if (found && !differs) {
      const Vec3d w(d);
      const double cosine = std::abs(dot(embree.shape(theirs.triangle).normal, w)) / length(w);
      const double apart = std::abs(double{ours.t} - double{theirs.t}) * length(w);
      differs = apart * cosine > 8e-6 * size * (from == 1 ? 8 : 1) ||
                (ours.triangle == theirs.triangle && ours.back != theirs.back);
    }
    const bool blocked = tracer.segment_blocked(o, o + d, 0);
    ++c.rays;
    c.hits += found;
    c.blocked += blocked;
    c.differ += differs || blocked != embree.segment_blocked(o, o + d, 0);
  }
  return c;
}

Scene slivers_and_corners_of_the_frame() {
  Scene scene = soup(500, 0.2);
  Rng rng(16, 0, 0);
  for (int i = 0; i < 500; ++i) {
    const Vec3d a = random_place(rng, 0.9);
    const Vec3d b = random_place(rng, 0.9);
    add(scene, Vec3f(a), Vec3f(b), Vec3f(b + random_place(rng, 1e-4)));
    const Vec3f corner(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    add(scene, corner, corner * 0.99f, Vec3f(corner.x, -corner.y, 0.99f * corner.z));
  }
  return scene;
}

TEST(traversal, rays_meet_what_embree_meets) {
  constexpr int kRays = 5000;
  constexpr int kAtEdges = 3;  // may differ, where an edge lies between two roundings
  for (const Scene& scene :
       {soup(1, 0.5), soup(2, 0.5), soup(3, 0.5), soup(5, 0.5), soup(9, 0.5), soup(300, 0.5),
        soup(70000, 0.01), slivers_and_corners_of_the_frame(), file("two-rooms.glb"),
        file("three-rooms.glb"), file("door-ajar.glb"), file("window.glb")}) {
    const Compared c = against_embree(scene, build_bvh(scene), kRays);
    EXPECT_LE(c.differ, kAtEdges) << scene.triangles.size();
    EXPECT_GT(c.hits, kRays / 50) << scene.triangles.size();
    EXPECT_GT(c.blocked, kRays / 100) << scene.triangles.size();
  }
  EXPECT_EQ(against_embree(no_triangles(), build_bvh(no_triangles()), 100).differ, 0);
  // Near 0 floats are precise enough for what is small.
  Scene tiny = soup(200, 0.5);
  for (Vec3f& p : tiny.positions) p *= 1e-6f;
  EXPECT_LE(against_embree(tiny, build_bvh(tiny), kRays, 1e-6).differ, kAtEdges);
}

TEST(traversal, twin_a_spoilt_hierarchy_differs) {
  const Scene scene = soup(300, 0.5), rooms = file("two-rooms.glb");
  Bvh box = build_bvh(scene), moved = box, lost = build_bvh(rooms);
  box.nodes[2].low0 = box.nodes[2].high0;
  for (shader::BvhTriangle& t : moved.triangles) t.p1.x += 1e-4f;
  for (shader::BvhTriangle& t : lost.triangles)
    if (t.triangle % 8 == 0) t.p1 = t.p0;
  EXPECT_GT(against_embree(scene, box, 5000).differ, 50);
  EXPECT_GT(against_embree(scene, moved, 5000).differ, 50);
  EXPECT_GT(against_embree(rooms, lost, 5000).differ, 50);
}

// --- The hierarchy itself ----------------------------------------------------------------------

/// Nodes from the root to the deepest leaf.
uint32_t depth_of(const Bvh& bvh, uint32_t node = 0) {
  if ((node & shader::kBvhLeaf) != 0) return 0;
  const BvhNode& n = bvh.nodes.at(node);
  return 1 + std::max(depth_of(bvh, n.child0), depth_of(bvh, n.child1));
}
void expect_each_triangle_once(const Bvh& bvh, const Scene& scene) {
  std::vector<int> seen(scene.triangles.size());
  for (const shader::BvhTriangle& t : bvh.triangles) ++seen.at(t.triangle);
  EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
  EXPECT_LE(depth_of(bvh), shader::kBvhStack);
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

TEST(bvh, no_input_goes_deeper_than_the_stack) {
  uint32_t deepest = 0;
  for (double factor : {0.9, 0.7, 0.5, 0.3, 0.1, 0.03}) {
    const Scene scene = dwindling(1000, factor);
    const Bvh bvh = build_bvh(scene);
    expect_each_triangle_once(bvh, scene);
    deepest = std::max(deepest, depth_of(bvh));
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
    const Bvh bvh = build_bvh(*scene);
    expect_each_triangle_once(bvh, *scene);
    SurfaceHit hit;
    for (int i = 0; i < 100; ++i)  // ends
      ScalarTracer(bvh).first_hit(Vec3f(random_place(rng, 1)), Vec3f(random_direction(rng)), 0,
                                  hit);
  }
}

TEST(bvh, a_million_copies_of_one_triangle) {
  Scene scene = no_triangles();
  add(scene, {-1, -1, 0.5f}, {1, -1, 0.5f}, {0, 1, 0.5f});
  scene.triangles.resize(1000000, scene.triangles[0]);
  const Bvh bvh = build_bvh(scene);
  expect_each_triangle_once(bvh, scene);
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

// --- Watertight --------------------------------------------------------------------------------

/// Calls from(o, d, i) `rays` times, with `o` inside a closed mesh, at the origin and elsewhere,
/// and d towards its corners, the middles of its edges, and in random directions.
template <class From>
void for_rays_within(const Scene& scene, int rays, From&& from) {
  Rng rng(18, 0, 0);
  for (int i = 0; i < rays; ++i) {
    const uint32_t t = rng.below(static_cast<uint32_t>(scene.triangles.size()));
    const Vec3f p = scene.vertex(t, i % 3), q = scene.vertex(t, (i + 1) % 3);
    const Vec3f o = i % 2 == 0 ? Vec3f() : Vec3f(random_place(rng, 0.3));
    Vec3f d(random_direction(rng));
    if (i % 4 < 2) d = p - o;
    if (i % 8 == 2 || i % 8 == 3) d = (p + q) * 0.5f - o;
    from(o, d, i);
  }
}

/// Factor that makes a ray along `d` longer than the mesh in any direction.
float reach_along(const Vec3f& d) {
  return 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
}

/// Number of rays from inside that leave the mesh, or from outside, near and far, that enter.
template <class Tracer>
int leaks(const Scene& scene, const Tracer& tracer, int rays) {
  int leaked = 0;
  for_rays_within(scene, rays, [&](const Vec3f& o, const Vec3f& d, int i) {
    SurfaceHit hit;
    leaked += !tracer.first_hit(o, d, 0, hit);
    leaked += !tracer.segment_blocked(o, o + d * (3 * reach_along(d)), 0);
    const float far = i % 3 == 0 ? 3.0f : i % 3 == 1 ? 60.0f : 3000.0f;
    const Vec3f outside = o + d * (reach_along(d) * far);
    leaked += !tracer.segment_blocked(outside, o, 0);
    leaked += !tracer.first_hit(outside, o - outside, 0, hit);
    leaked += hit.t > 1;
  });
  return leaked;
}

constexpr int kLeakRays = 1 << 15;  // each as a ray and as a segment, in each of two meshes

TEST(traversal, no_ray_leaves_a_closed_mesh) {
  for (const Scene& scene : {file("furnace.glb"), sphere(200, 0.95)}) {
    const Bvh bvh = build_bvh(scene);
    EXPECT_EQ(leaks(scene, ScalarTracer(bvh), kLeakRays), 0);
    Bvh apart = bvh;  // twin: triangles with a gap of about a rounding between them
    for (shader::BvhTriangle& t : apart.triangles) {
      const Vec3f middle = (t.p0 + t.p1 + t.p2) / 3.0f;
      for (Vec3f* p : {&t.p0, &t.p1, &t.p2}) *p = *p + normalize(middle - *p) * 2e-7f;
    }
    EXPECT_GT(leaks(scene, ScalarTracer(apart), kLeakRays / 16), 100);
    // By Embree in its robust mode, from inside, through edges and in random directions. Of rays
    // aimed exactly at a corner of the sphere 1 in 70 leaks, and so do some from far outside.
    const Tracer tracer(scene);
    for_rays_within(scene, kLeakRays, [&](const Vec3f& o, const Vec3f& d, int i) {
      if (i % 4 < 2) return;
      SurfaceHit hit;
      ASSERT_TRUE(tracer.first_hit(o, d, 0, hit));
      ASSERT_TRUE(tracer.segment_blocked(o, o + d * (3 * reach_along(d)), 0));
    });
  }
  // Twin with tight boxes.
  const Scene scene = sphere(200, 0.95);
  Bvh tight = build_bvh(scene);
  const Vec3f pad(0x1p-18f * tight.nodes[0].extent);
  for (BvhNode& n : tight.nodes) {
    n.low0 = n.low0 + pad;
    n.low1 = n.low1 + pad;
    n.high0 = n.high0 - pad;
    n.high1 = n.high1 - pad;
  }
  EXPECT_GT(leaks(scene, ScalarTracer(tight), kLeakRays), 5);
}

TEST(traversal, edge_functions_have_the_exact_sign) {
  const auto sign = [](auto x) { return (x > 0) - (x < 0); };
  Rng rng(19, 0, 0);
  int plain_wrong = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto coordinate = [&] {
      return static_cast<float>((rng.uniform() * 2 - 1) * std::exp2(-36 * rng.uniform()));
    };
    const float x = coordinate();
    const float y = coordinate();
    const float s = coordinate();
    // Nearly parallel: the products agree except for a few units in the last place.
    const Vec3f a(x, y, 0), b(x * s, y * s, 0);
    if (std::abs(b.x) < 0x1p-38f || std::abs(b.y) < 0x1p-38f) continue;
    // Products of floats are exact in double, and so is the order of two of them.
    const double p = double{a.x} * b.y, q = double{a.y} * b.x;
    const int exact = (p > q) - (p < q);
    ASSERT_EQ(sign(shader::edge_function(a, b)), exact);
    ASSERT_EQ(sign(shader::edge_function(b, a)), -exact);
    plain_wrong += sign(a.x * b.y - a.y * b.x) != exact;
  }
  EXPECT_GT(plain_wrong, 1000);  // twin
}

// --- Special places ----------------------------------------------------------------------------

// A square of 1 x 1 at z = 0 that faces up, and a larger one at z = -0.5.
Scene two_squares() {
  Scene scene = no_triangles();
  for (const auto& [h, z] : {std::pair{0.5f, 0.0f}, std::pair{0.75f, -0.5f}}) {
    add(scene, {-h, -h, z}, {h, -h, z}, {h, h, z});
    add(scene, {-h, -h, z}, {h, h, z}, {-h, h, z});
  }
  return scene;
}

TEST(traversal, segments_are_open_at_both_ends) {
  const Scene scene = two_squares();
  const Bvh bvh = build_bvh(scene);
  const ScalarTracer t(bvh);
  Rng rng(21, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    // Steep enough that z is the main axis, which has no rounding.
    const Vec3f p(Vec3d(0.9, 0.9, 0) * random_place(rng, 0.5));
    const Vec3f q(Vec3d(p) + Vec3d(1, 1, 0) * random_place(rng, 0.04));
    const Vec3f above(q.x, q.y, 0.25f), below(q.x, q.y, -0.25f);
    // At any angle, with the usual offset.
    const Vec3f far(Vec3d(0.9, 0.9, 0) * random_place(rng, 0.5) + Vec3d(0, 0, 0.01));
    const Vec3f off = p + Vec3f(0, 0, 0x1p-21f), under = p - Vec3f(0, 0, 0x1p-21f);
    const auto blocked_either_way = [&](const Vec3f& a, const Vec3f& b) {
      EXPECT_EQ(t.segment_blocked(a, b, 0), t.segment_blocked(b, a, 0));
      return t.segment_blocked(a, b, 0);
    };
    EXPECT_FALSE(blocked_either_way(p, above));
    EXPECT_FALSE(blocked_either_way(p, below));
    EXPECT_FALSE(blocked_either_way(p, p));
    EXPECT_FALSE(blocked_either_way(p, q)) << "in the square's own plane";
    EXPECT_FALSE(blocked_either_way(off, far));
    EXPECT_TRUE(blocked_either_way(above, below));
    EXPECT_TRUE(blocked_either_way(under, far));
    SurfaceHit hit;
    EXPECT_FALSE(t.first_hit(p, {}, 0, hit));
    EXPECT_FALSE(t.first_hit(p, above - p, 0, hit));
    EXPECT_FALSE(t.first_hit(p, q - p, 0, hit));
    ASSERT_TRUE(t.first_hit(p, below - p, 0, hit));  // leaves one, hits the other
    EXPECT_GE(hit.triangle, 2u);
  }
}

TEST(traversal, a_direction_may_have_any_length) {
  const Scene scene = two_squares();
  const Bvh bvh = build_bvh(scene);
  const ScalarTracer t(bvh);
  for (float length : {1e-35f, 1e-18f, 1e-3f, 1.0f, 1e3f, 1e18f, 1e35f}) {
    SurfaceHit hit;
    ASSERT_TRUE(t.first_hit({0.1f, 0.2f, 0.5f}, Vec3f(0.1f, 0, -1) * length, 0, hit)) << length;
    EXPECT_NEAR(hit.t * length, 0.5f, 1e-6f);
  }
}

TEST(traversal, of_coincident_triangles_the_first_one_is_met) {
  Scene scene = soup(2000, 0.2);
  const auto n = static_cast<uint32_t>(scene.triangles.size());
  for (uint32_t t = 0; t < n; ++t) scene.triangles.push_back(scene.triangles[t]);
  Bvh bvh = build_bvh(scene);
  Bvh turned = bvh;  // the same tree, traversed in another order
  for (BvhNode& node : turned.nodes) {
    std::swap(node.low0, node.low1);
    std::swap(node.high0, node.high1);
    std::swap(node.child0, node.child1);
  }
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    Rng rng(13, 0, static_cast<uint64_t>(i));
    const Vec3f o(random_place(rng, 1)), d(random_direction(rng));
    SurfaceHit a, b;
    ScalarTracer(bvh).first_hit(o, d, 0, a);
    if (!ScalarTracer(turned).first_hit(o, d, 0, b)) continue;
    ++hits;
    ASSERT_LT(a.triangle, n);
    ASSERT_EQ(std::memcmp(&a, &b, sizeof a), 0);
  }
  EXPECT_GT(hits, 10000);
}

TEST(traversal, a_surface_that_is_not_there_is_passed) {
  Scene scene = two_squares();
  scene.materials.resize(2);
  scene.materials[1].alpha_mode = Material::Alpha::blend;
  for (uint32_t t = 0; t < 2; ++t) scene.triangles[t].material = 1;
  const Bvh bvh = build_bvh(scene);
  const shader::traversal_test::ScreenTracer tracer(bvh);
  const Vec3f above(0.2f, 0.1f, 0.25f);  // over triangle 0
  for (uint32_t coin = 0; coin < 10; ++coin) {
    SurfaceHit hit;
    ASSERT_TRUE(tracer.first_hit(above, {0, 0, -1}, coin, hit));
    EXPECT_EQ(hit.triangle, coin % 2 == 0 ? 2u : 0u);
    EXPECT_EQ(tracer.segment_blocked(above, {0.2f, 0.1f, -0.25f}, coin), coin % 2 == 1);
    EXPECT_TRUE(tracer.segment_blocked(above, {0.2f, 0.1f, -0.75f}, coin));
  }
}

}  // namespace tdpt::traversal_test
