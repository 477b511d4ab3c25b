#include "libcommon/trace/tracer.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/scenes/meshes.h"
#include "libcommon/testing/tracer_faults.h"
#include "shaders/shared/bvh.h"

namespace tdpt::tracer_test {

using testing::random_direction;

// The furnace: a closed convex box, so every ray hits, and any two points on it see each other.
struct Box {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/furnace.glb");
  Tracer tracer{scene};
};

TEST(tracer, no_ray_escapes_a_closed_box) {
  Box box;
  Rng rng(1, 0, 0);
  Hit hit;
  int from_air = 0, from_wall = 0;
  for (int i = 0; i < 1 << 16; ++i) {
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

// From behind, too: Embree can be built with backface culling, by which light would enter there.
TEST(tracer, walls_are_met_from_either_side_where_ray_and_triangle_meet) {
  Box box;
  Rng rng(2, 0, 0);
  Hit hit, behind;
  const Vec3d o{0.1, -0.2, 0.05};
  for (int i = 0; i < 10000; ++i) {
    const Vec3d w = random_direction(rng);
    ASSERT_TRUE(box.tracer.closest({o, {}}, w, hit));
    EXPECT_NEAR(length(o + w * hit.distance - hit.position), 0, 2e-6);
    EXPECT_NEAR(dot(hit.normal, hit.position - box.tracer.shape(hit.triangle).p0), 0, 1e-12);
    EXPECT_LT(dot(hit.normal, w), 0);
    ASSERT_TRUE(box.tracer.closest({w * 4.0}, -w, behind));
    EXPECT_GT(dot(behind.normal, -w), 0);
  }
  const Tracer::Origin outside{{3, 0, 0}, {}};
  EXPECT_FALSE(box.tracer.visible({o}, outside));
  const Scene nothing;
  EXPECT_FALSE(Tracer(nothing).closest({o}, {1, 0, 0}, hit));
  EXPECT_TRUE(Tracer(nothing).visible({o}, outside));
}

// Number of pairs of points on the box that do not see each other; the offset is scaled.
int hidden_pairs(double offset_scale) {
  Box box;
  TracerFaults::scale_step(box.tracer, offset_scale);
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
  for (int i = 0; i < 50000; ++i) {
    const Tracer::Origin a = place();
    const Tracer::Origin b = place();
    const Vec3d d = b.position - a.position;
    if (dot(a.normal, d) < 1e-3 || dot(b.normal, d) > -1e-3) continue;
    hidden += !box.tracer.visible(a, b);
    EXPECT_EQ(box.tracer.visible(a, b), box.tracer.visible(b, a));
  }
  return hidden;
}

TEST(tracer, corners_read_in_place_and_copied_ones_are_hit_alike) {
  Box box;
  ASSERT_GT(box.scene.positions.capacity(), box.scene.positions.size()) << "read_gltf makes room";
  Scene copied = box.scene;
  copied.positions.shrink_to_fit();
  ASSERT_EQ(copied.positions.capacity(), copied.positions.size());
  const Tracer other(copied);
  Rng rng(3, 0, 0);
  for (int i = 0; i < 10000; ++i) {
    const Vec3d w = random_direction(rng);
    Hit a, b;
    ASSERT_TRUE(box.tracer.closest({{0.1, -0.2, 0.05}, {}}, w, a));
    ASSERT_TRUE(other.closest({{0.1, -0.2, 0.05}, {}}, w, b));
    ASSERT_EQ(a.triangle, b.triangle);
    ASSERT_EQ(a.position, b.position);
  }
}

TEST(tracer, places_on_a_convex_box_see_each_other) {
  EXPECT_EQ(hidden_pairs(1), 0);
  EXPECT_EQ(hidden_pairs(2), 0) << "twice the step";
  EXPECT_GT(hidden_pairs(0), 100) << "twin without the step: surfaces hide themselves";
}

// Closed boxes with the outsides of their walls in front: straight, turned, sheared to edges of 30
// and 150 degrees, and thin; each with corners of its own at every wall, along either diagonal.
struct Walls {
  Walls(const char* name_, const std::array<Vec3d, 4>& p, bool other_diagonal) : name(name_) {
    const auto corner = [&](int i) {
      return p[0] + (i & 1 ? p[1] : Vec3d()) + (i & 2 ? p[2] : Vec3d()) + (i & 4 ? p[3] : Vec3d());
    };
    scene.materials.emplace_back();
    for (const auto& f : {std::array{0, 4, 6, 2},
                          {1, 3, 7, 5},
                          {0, 1, 5, 4},
                          {2, 6, 7, 3},
                          {0, 2, 3, 1},
                          {4, 5, 7, 6}}) {
      const auto first = static_cast<uint32_t>(scene.positions.size());
      for (const int i : f) scene.positions.emplace_back(corner(i));
      const uint32_t turn = other_diagonal ? 1 : 0, third = first + 2 + turn;
      scene.triangles.push_back({{first + turn, first + 1 + turn, third}, 0});
      scene.triangles.push_back({{first + turn, third, first + (3 + turn) % 4}, 0});
      for (size_t i = 0; i < 4; ++i) edges.push_back({corner(f[i]), corner(f[(i + 1) % 4])});
    }
    middle = (corner(0) + corner(7)) / 2;
    tracer = std::make_unique<Tracer>(scene);
  }
  const char* name;
  Scene scene;
  std::vector<std::array<Vec3d, 2>> edges;
  Vec3d middle;
  std::unique_ptr<Tracer> tracer;
};
std::vector<std::unique_ptr<Walls>> all_walls() {
  const Vec3d x = normalize(Vec3d(0.7, 0.2, -0.4)), y = normalize(cross(x, Vec3d(0.1, 1, 0.3)));
  const Vec3d z = cross(x, y), low(-0.9, -0.61, -0.7);
  std::vector<std::unique_ptr<Walls>> all;
  const auto add = [&](const char* name, const std::array<Vec3d, 4>& p) {
    for (const bool other : {false, true}) all.push_back(std::make_unique<Walls>(name, p, other));
  };
  add("straight", {low, {1.8, 0, 0}, {0, 1.37, 0}, {0, 0, 1.8}});
  add("turned", {Vec3d(-0.2, -0.1, 0.1), x * 0.9, y * 0.7, z * 0.5});
  add("sheared", {low, {1.1, 0, 0}, {0.6, 0.4, 0}, {0, 0, 1.5}});
  add("thin", {Vec3d(-0.9, 0.3, 0.3), {1.8, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}});
  return all;
}
// The same without looking again at what lies near an edge.
bool plain_hit(const Walls& walls, const Tracer::Origin& from, const Vec3d& w, Hit& hit) {
  shader::SurfaceHit found;
  const double step = from.normal == Vec3d() ? 0 : dot(from.normal, w) < 0 ? -4.8e-7 : 4.8e-7;
  hit.triangle = ~0u;
  if (!walls.tracer->first_hit(Vec3f(from.position + from.normal * step), Vec3f(w), 0, found))
    return false;
  const TriangleShape& s = walls.tracer->shape(found.triangle);
  hit.triangle = found.triangle, hit.normal = s.normal;
  hit.position = s.p0 + s.e1 * found.b1 + s.e2 * found.b2;
  return true;
}
// Rays to places within rounding of an edge: those from outside that meet the inside of a wall, and
// those from inside that leave after they have scattered there.
template <class Closest>
int leaks(const Walls& walls, const Closest& closest) {
  int leaks = 0;
  Rng rng(11, 0, 0);
  for (int i = 0; i < 20000; ++i) {
    const auto& [a, b] = walls.edges[rng.below(static_cast<uint32_t>(walls.edges.size()))];
    const double along = rng.uniform();
    const Vec3d at = a + (b - a) * along + random_direction(rng) * (1.5e-7 * rng.uniform());
    const Vec3d w = random_direction(rng);
    const Vec3d between = a + (b - a) * rng.uniform();
    Hit hit;
    if (closest({at - w * 3.5, {}}, w, hit)) leaks += dot(hit.normal, w) > 0;
    const Vec3d inside = walls.middle + (between - walls.middle) * (0.9 * rng.uniform());
    if (!closest({inside, {}}, normalize(at - inside), hit)) {
      leaks += hit.triangle == ~0u;
      continue;
    }
    const Vec3d out = random_direction(rng);
    const Tracer::Origin wall{hit.position, hit.normal, hit.triangle};
    const Vec3d v = dot(out, hit.normal) < 0 ? out : -out;
    if (closest(wall, v, hit))
      leaks += dot(hit.normal, v) < 0;
    else
      leaks += hit.triangle == ~0u;
  }
  return leaks;
}
TEST(tracer, walls_that_meet_in_an_edge_let_no_light_through) {
  for (const auto& walls : all_walls()) {
    const auto with_second_look = [&](const Tracer::Origin& from, const Vec3d& w, Hit& hit) {
      return walls->tracer->closest(from, w, hit);
    };
    const auto without = [&](const Tracer::Origin& from, const Vec3d& w, Hit& hit) {
      return plain_hit(*walls, from, w, hit);
    };
    EXPECT_EQ(leaks(*walls, with_second_look), 0) << walls->name;
    EXPECT_GT(leaks(*walls, without), 10) << walls->name << ", twin";
  }
}

// ---- Culling ----

// From outside the furnace, whose walls face inwards: compared with stepping through every back.
TEST(tracer, a_camera_that_culls_meets_the_first_front) {
  Box box;
  const Tracer culling(box.scene, true);
  const Vec3d eye{2.5, 0.7, 1.8};
  Rng rng(4, 0, 0);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d w = normalize(random_direction(rng) * 0.5 - eye);
    Hit hit, seen;
    bool any = box.tracer.closest({eye}, w, hit);
    const bool back_first = any && dot(hit.normal, w) > 0;
    if (back_first) any = box.tracer.closest({hit.position, hit.normal}, w, hit);
    ASSERT_EQ(culling.first_seen(eye, w, seen), any);
    if (!any) continue;
    met += back_first;
    EXPECT_EQ(seen.triangle, hit.triangle);
    EXPECT_LT(dot(seen.normal, w), 0);
    EXPECT_TRUE(culling.sees(eye, {seen.position, seen.normal}));
    EXPECT_FALSE(culling.visible({eye}, {seen.position, seen.normal})) << "light";
    EXPECT_FALSE(box.tracer.sees(eye, {seen.position, seen.normal})) << "twin that does not cull";
  }
  EXPECT_GT(met, 1500);
}

TEST(tracer, a_camera_that_culls_draws_fronts_and_what_is_double_sided) {
  Box box;
  box.scene.materials[0].double_sided = true;
  const Tracer culling(box.scene, true);
  const Vec3d eye{2.5, 0.7, 1.8}, w = normalize(-eye);
  Hit hit, seen;
  ASSERT_TRUE(culling.closest({eye}, w, hit) && culling.first_seen(eye, w, seen));
  EXPECT_EQ(hit.triangle, seen.triangle);
  EXPECT_TRUE(culling.draws(hit.triangle, w));
  box.scene.materials[0].double_sided = false;
  EXPECT_FALSE(culling.draws(hit.triangle, w));
  EXPECT_TRUE(culling.draws(hit.triangle, -w));
  EXPECT_TRUE(box.tracer.draws(hit.triangle, w));
}

// A square of 1 x 1 at z = 0 with partial coverage, and a floor at z = -1.
Scene veil(const Material& material) {
  Scene scene;
  scene.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0},
                     {-20, -20, -1},    {20, -20, -1},    {0, 30, -1}};
  scene.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}, {{4, 5, 6}, 1}};
  scene.materials = {material, Material()};
  return scene;
}

struct Share {
  double closest, visible;  ///< of rays that pass
};
/// For parallel rays at cosine 0.5 through random points of the veil.
Share share_that_passes(const Scene& scene) {
  const Tracer tracer(scene);
  const Vec3d w(std::sqrt(0.75), 0, -0.5);
  constexpr int n = 40000;
  int closest = 0, visible = 0;
  for (int i = 0; i < n; ++i) {
    Rng rng(4, 0, static_cast<uint64_t>(i));
    const double x = rng.uniform() - 0.5;
    const double y = rng.uniform() - 0.5;
    const Vec3d at(x, y, 0);
    Hit hit;
    closest += tracer.closest({at - w * 0.3, {}}, w, hit) && hit.triangle == 2;
    visible += tracer.visible({at - w * 0.3, {}}, {at + w * 0.4, {}});
  }
  return {double{1} * closest / n, double{1} * visible / n};
}

void expect_share(const Scene& scene, double expected, bool right = true) {
  const Share share = share_that_passes(scene);
  const double sigma = std::sqrt(expected * (1 - expected) / 40000);
  EXPECT_EQ(std::abs(share.closest - expected) < 5 * sigma, right) << share.closest;
  EXPECT_EQ(std::abs(share.visible - expected) < 5 * sigma, right) << share.visible;
}

TEST(tracer, a_blend_is_there_as_often_as_its_alpha_says) {
  Material m;
  m.plain = false;
  m.alpha_mode = Material::Alpha::blend;
  m.alpha = 0.3f;
  expect_share(veil(m), 0.7);
  expect_share(veil(m), 0.72, false);  // twin
}

// Shares of rays of a culling camera that hit a blend of 0.3, and that are blocked by it.
TEST(tracer, culling_goes_with_coverage) {
  Material m;
  m.plain = false;
  m.alpha_mode = Material::Alpha::blend;
  m.alpha = 0.3f;
  const auto met = [](const Material& material, double from) {
    const Scene scene = veil(material);
    const Tracer tracer(scene, true);
    int n = 0, hidden = 0;
    for (int i = 0; i < 10000; ++i) {
      Rng rng(6, 0, static_cast<uint64_t>(i));
      const double x = 0.9 * (rng.uniform() - 0.5);
      const double y = 0.9 * (rng.uniform() - 0.5);
      const Vec3d eye{x, y, from};
      Hit hit;
      n += tracer.first_seen(eye, {0, 0, from < 0 ? 1.0 : -1.0}, hit) && hit.triangle < 2;
      hidden += !tracer.sees(eye, {{x, y, -from}});
    }
    EXPECT_NEAR(n, hidden, 300);
    return n / 10000.0;
  };
  EXPECT_NEAR(met(m, 0.5), 0.3, 0.03);
  EXPECT_EQ(met(m, -0.5), 0);
  m.double_sided = true;
  EXPECT_NEAR(met(m, -0.5), 0.3, 0.03);
}

TEST(tracer, a_mask_is_there_or_not) {
  Material m;
  m.plain = false;
  m.alpha_mode = Material::Alpha::mask;
  for (float alpha : {0.4f, 0.6f}) {
    m.alpha = alpha;
    const Share share = share_that_passes(veil(m));
    EXPECT_EQ(share.closest, alpha < m.alpha_cutoff ? 1 : 0);
    EXPECT_EQ(share.visible, alpha < m.alpha_cutoff ? 1 : 0);
  }
}

// Schlick at cosine 0.5 from 0.04: F = 0.04 + 0.96 / 32 = 0.07.
TEST(tracer, a_pane_lets_pass_what_it_does_not_reflect) {
  Material m;
  m.plain = false;
  m.base_color = Rgb(0.9f);
  m.specular = 1;
  m.transmission = 1;
  m.roughness = 0;
  expect_share(veil(m), 0.9 * 0.93);
  expect_share(veil(m), 0.9 * 0.96, false);  // twin: the reflectance at normal incidence
  Hit hit;
  const Scene scene = veil(m);
  const Tracer tracer(scene);
  for (int i = 0; i < 1000; ++i) {
    const double x = i * 1e-3 - 0.5;
    ASSERT_TRUE(tracer.closest({{x, 0.3 * x, 0.5}, {}}, {0, 0, -1}, hit));
    if (hit.triangle == 2) continue;
    EXPECT_NEAR(hit.opacity, 1 - 0.9 * 0.96, 1e-6);
  }
  // Anything that colours, refracts or blurs the light is no pane: rays stop there.
  for (int k = 0; k < 5; ++k) {
    Material other = m;
    if (k == 4) other.coloured = true;
    if (k == 0) other.base_color = Rgb(0.9f, 0.9f, 0.8f);
    if (k == 1) other.solid = true;
    if (k == 2) other.roughness = 0.1f;
    if (k == 3) other.transmission = 0;
    EXPECT_EQ(share_that_passes(veil(other)).closest, 0) << k;
  }
}

}  // namespace tdpt::tracer_test
