#include "libcommon/trace/tracer.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

Vec3d random_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1;
  const double phi = 6.283185307179586 * rng.uniform();
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// The furnace: a closed convex box, so every ray hits, and any two places on it see each other.
struct Box {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/furnace.glb");
  Tracer tracer{scene};
};

TEST(tracer, no_ray_escapes_a_closed_box) {
  Box box;
  Rng rng(1, 0, 0);
  Hit hit;
  int from_air = 0, from_wall = 0;
  for (int i = 0; i < 1 << 19; ++i) {
    if (!box.tracer.closest({{0.01, 0.02, 0.03}, {}}, random_direction(rng), hit)) {
      ++from_air;
      continue;
    }
    const Tracer::Origin wall{hit.position, hit.normal};
    const Vec3d w = random_direction(rng);
    from_wall += !box.tracer.closest(wall, dot(w, wall.normal) > 0 ? w : -w, hit);
  }
  EXPECT_EQ(from_air, 0);
  EXPECT_EQ(from_wall, 0);
}

TEST(tracer, hit_points_lie_on_their_ray_and_triangle) {
  Box box;
  Rng rng(2, 0, 0);
  Hit hit;
  const Vec3d o{0.1, -0.2, 0.05};
  for (int i = 0; i < 10000; ++i) {
    const Vec3d w = random_direction(rng);
    ASSERT_TRUE(box.tracer.closest({o, {}}, w, hit));
    EXPECT_NEAR(length(o + w * hit.distance - hit.position), 0, 2e-6);
    EXPECT_NEAR(dot(hit.normal, hit.position - box.tracer.shape(hit.triangle).p0), 0, 1e-12);
  }
}

// Pairs of places on the box, how many do not see each other; `normal` scales the step off.
int hidden_pairs(double offset_scale) {
  Box box;
  box.tracer.set_offset_scale(offset_scale);
  Rng rng(3, 0, 0);
  const auto place = [&] {
    const uint32_t t = rng.below(static_cast<uint32_t>(box.scene.triangles.size()));
    const TriangleShape& s = box.tracer.shape(t);
    const double u = rng.uniform();
    const double v = rng.uniform();
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    return Tracer::Origin{s.p0 + s.e1 * b1 + s.e2 * b2, s.normal};
  };
  int hidden = 0;
  for (int i = 0; i < 200000; ++i) {
    const Tracer::Origin a = place();
    const Tracer::Origin b = place();
    const Vec3d d = b.position - a.position;
    if (dot(a.normal, d) < 1e-3 || dot(b.normal, d) > -1e-3) continue;
    hidden += !box.tracer.visible(a, b);
    EXPECT_EQ(box.tracer.visible(a, b), box.tracer.visible(b, a));
  }
  return hidden;
}

TEST(tracer, places_on_a_convex_box_see_each_other) {
  EXPECT_EQ(hidden_pairs(1), 0);
}
TEST(tracer, twice_the_step_sees_the_same) {
  EXPECT_EQ(hidden_pairs(2), 0);
}
TEST(tracer, twin_without_the_step_surfaces_hide_themselves) {
  EXPECT_GT(hidden_pairs(0), 100);
}

TEST(tracer, a_wall_hides_and_an_empty_scene_has_no_hits) {
  Box box;
  const Tracer::Origin inside{{0, 0, 0}, {}}, outside{{3, 0, 0}, {}};
  EXPECT_FALSE(box.tracer.visible(inside, outside));
  const Scene nothing;
  Hit hit;
  EXPECT_FALSE(Tracer(nothing).closest(inside, {1, 0, 0}, hit));
  EXPECT_TRUE(Tracer(nothing).visible(inside, outside));
}

}  // namespace
}  // namespace tdpt
