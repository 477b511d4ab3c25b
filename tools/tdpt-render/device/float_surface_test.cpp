// Surfaces as kernels see them (shaders/shared/path/surface.h): the material at a point, against
// the renderer in doubles, and on a device against C++, bit for bit.
#include <gtest/gtest.h>

#include "libcommon/gpu/kernel.h"
#include "libcommon/scene/scene.h"
#include "libcommon/scene/texture.h"
#include "shaders/surface_test.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/surface_scene.h"
#include "tools/tdpt-render/testing/surface_words.h"

namespace tdpt::float_surface_test {

using test::SurfaceHeap;

constexpr double kUnit = 16;

Camera any_camera() {
  Camera c;
  c.position = {0, 0, 3}, c.right = {1, 0, 0}, c.up = {0, 1, 0}, c.forward = {0, 0, -1};
  return c;
}

// A heap in doubles and in floats.
struct Both {
  explicit Both(double reach = 3)
      : heap(reach), tables(make_surfaces(heap.scene(), kUnit)), scalar(tables, curves) {}
  const Scene& scene() const { return heap.scene(); }

  SurfaceHeap heap;
  shader::Curves curves;
  SurfaceTables tables;
  shader::ScalarSurface scalar;
};

struct Place {
  uint32_t triangle;
  float b1, b2;
};
Place draw_place(uint64_t i) {
  Rng rng(31, 0, i);
  const float b1 = rng.uniform_float();
  const float b2 = rng.uniform_float() * (1 - b1);
  return {static_cast<uint32_t>(i % SurfaceHeap::kTriangles), b1, b2};
}

double distance(const Vec3f& a, const Vec3d& b) {
  return length(Vec3d(a) - b);
}
double distance(const Rgb& a, const Rgb& b) {
  return length(Vec3d(a) - Vec3d(b));
}
double distance(const shader::Bsdf& a, const Bsdf& b) {
  double d = distance(a.diffuse, b.diffuse) + distance(a.f0, b.f0) + std::abs(a.f90 - b.f90) +
             distance(a.through, b.through) + distance(a.dip, b.dip) + distance(a.sheen, b.sheen) +
             std::abs(a.alpha - b.alpha) + std::abs(a.eta - b.eta) + (a.thin != b.thin);
  if (max_component(b.sheen) > 0) d += std::abs(a.sheen_alpha - b.sheen_alpha);
  d += std::abs(a.coat.strength - b.coat.strength);
  if (!(b.coat.strength > 0)) return d;
  d += std::abs(a.coat.alpha - b.coat.alpha) + distance(a.coat.normal, Vec3d(b.coat.normal));
  return max_component(b.diffuse) > 0 ? d + distance(a.coat.under, b.coat.under) : d;
}
double distance(const shader::Point& a, const Point& b) {
  double d = distance(a.position, b.position) + distance(a.normal, b.normal);
  d += (a.simple != bool(b.simple)) + (a.connectible != b.connectible);
  const uint32_t source = !b.source                  ? shader::SOURCE_NONE
                          : b.material->double_sided ? shader::SOURCE_BOTH
                                                     : shader::SOURCE_FRONT;
  d += a.source != source;
  d += distance(a.emission * static_cast<float>(kUnit / 50), b.emission * (1.0f / 50));
  if (b.simple) return d + distance(a.color, b.color);
  return d + distance(a.shading, b.shading) + distance(a.bsdf, b.bsdf);
}

// Distances between points in floats and in doubles, sorted; `shift` moves them apart.
std::vector<double> distances(const Both& both, float shift) {
  const Vista vista(both.scene(), any_camera(), 4, 4, {});
  std::vector<double> found;
  for (uint64_t i = 0; i < 40 * SurfaceHeap::kTriangles; ++i) {
    const Place at = draw_place(i);
    shader::Point mine;
    both.scalar.place_on_surface(at.triangle, at.b1 + shift, at.b2, mine);
    Hit hit;
    const TriangleShape s = shape_of(both.scene(), at.triangle);
    hit.triangle = at.triangle, hit.b1 = at.b1, hit.b2 = at.b2;
    hit.position = s.p0 + s.e1 * hit.b1 + s.e2 * hit.b2, hit.normal = s.normal;
    Point exact;
    place_on_surface(*vista.world, hit, exact);
    found.push_back(distance(mine, exact));
  }
  std::sort(found.begin(), found.end());
  return found;
}
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
}

// Two things may differ: a texel without interpolation, at its edge, and what flips with a normal.
TEST(float_surface, places_are_those_of_doubles) {
  const std::vector<double> d = distances(Both(), 0);
  EXPECT_LT(quantile(d, 0.5), 2e-6);
  EXPECT_LT(quantile(d, 0.99), 1e-4);
  EXPECT_LT(quantile(d, 0.999), 1e-3);
}
TEST(float_surface, twin_places_a_thousandth_of_an_edge_away) {
  EXPECT_GT(quantile(distances(Both(), 1e-3f), 0.5), 1e-4);
}
TEST(float_surface, textures_hold_where_coordinates_are_far_from_0) {
  EXPECT_LT(quantile(distances(Both(300), 0), 0.9), 1e-2);
}

TEST(float_surface, coverage_and_opacity_are_those_of_doubles) {
  const Both both;
  int different = 0, alphas = 0, panes = 0;
  for (uint64_t i = 0; i < 40 * SurfaceHeap::kTriangles; ++i) {
    const Place at = draw_place(i);
    const float mine = both.scalar.coverage_at(at.triangle, at.b1, at.b2);
    const float exact = coverage_at(both.scene(), {at.triangle, at.b1, at.b2});
    different += std::abs(mine - exact) > 1e-4f;
    alphas += exact > 0 && exact < 1;
    Rng rng(32, 0, i);
    const Vec3d w(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
    const Pane pane = pane_of(both.scene().material_of(at.triangle));
    const double cos = dot(shape_of(both.scene(), at.triangle).normal, w) / length(w);
    const double opacity = pane ? pane.opacity(cos) : 1;
    EXPECT_NEAR(both.scalar.opacity_at(at.triangle, Vec3f(w * 1e-3)), opacity, 2e-6);
    panes += opacity < 1;
  }
  EXPECT_LT(different, 30);
  EXPECT_GT(alphas, 500);
  EXPECT_GT(panes, 500);
}

TEST(float_surface, rays_are_stopped_as_often_as_coverage_and_opacity_say) {
  const Both both;
  const Vec3f w(0.3f, -0.5f, 0.9f);
  for (uint32_t t = 0; t < SurfaceHeap::kTriangles; ++t) {
    const double share =
        double{both.scalar.coverage_at(t, 0.3f, 0.2f)} * both.scalar.opacity_at(t, w);
    int stopped = 0;
    for (uint32_t coin = 0; coin < 2000; ++coin)
      stopped += both.scalar.surface_stops(t, 0.3f, 0.2f, coin * 0x9E3779B9u, w);
    EXPECT_NEAR(stopped / 2000.0, share, 5 * std::sqrt(share * (1 - share) / 2000) + 1e-9) << t;
  }
}

TEST(float_surface, the_inside_of_a_solid_absorbs) {
  const Both both;
  const Vista vista(both.scene(), any_camera(), 4, 4, {});
  int absorbed = 0;
  for (uint64_t i = 0; i < SurfaceHeap::kTriangles; ++i) {
    shader::Point a, b;
    both.scalar.place_on_surface(draw_place(i).triangle, 0.2f, 0.3f, a);
    both.scalar.place_on_surface(draw_place(i + 7).triangle, 0.2f, 0.3f, b);
    const auto exact_of = [&](const shader::Point& p) {
      Point q;
      q.normal = Vec3d(p.normal), q.material = &both.scene().material_of(p.triangle);
      return q;
    };
    const Vec3f w = shader::normalized(b.position - a.position);
    const Rgb mine = both.scalar.transmittance(a, b, w, 0.7f);
    EXPECT_LT(distance(mine, transmittance(exact_of(a), exact_of(b), Vec3d(w), double{0.7f})),
              1e-6);
    absorbed += mine != Rgb(1.0f);
    EXPECT_EQ(both.scalar.transmittance(a, b, w, 0), Rgb(1.0f));
  }
  EXPECT_GT(absorbed, 20);
}

TEST(float_surface, plain_scenes_have_no_tables_but_faces_and_materials) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{{0, 1, 2}, 0}};
  scene.materials.resize(1);
  const SurfaceTables t = make_surfaces(scene, 1);
  EXPECT_EQ(t.faces.size(), 1u);
  EXPECT_TRUE(t.maps.empty() && t.face_corners.empty() && t.corner_attributes.empty() &&
              t.texel_words.empty() && t.coverage.coverage_of.empty());
  const SurfaceFeatures& f = t.features;
  EXPECT_FALSE(f.layers || f.normals || f.textures || f.colours || f.coats || f.sheen ||
               f.transmission || f.absorption || f.panes || f.coverage || f.coverage_textures);
}

// Coordinates that are NaN or huge give some colour, and nothing worse.
TEST(float_surface, any_texture_coordinates_will_do) {
  for (const float odd : {1e9f, -1e20f, 3e38f, INFINITY, NAN}) {
    Scene scene = SurfaceHeap().scene();
    for (auto& uv : scene.uv)
      for (size_t i = 0; i < uv.size(); i += 2) uv[i] = {odd, odd};
    const SurfaceTables tables = make_surfaces(scene, 1);
    const shader::Curves curves;
    const shader::ScalarSurface scalar(tables, curves);
    for (uint64_t i = 0; i < 4 * SurfaceHeap::kTriangles; ++i) {
      const Place at = draw_place(i);
      shader::Point p;
      scalar.place_on_surface(at.triangle, at.b1, at.b2, p);
      ASSERT_TRUE(is_finite(p.shading) && is_finite(p.bsdf.diffuse) && is_finite(p.emission))
          << odd;
      ASSERT_NEAR(length(Vec3d(p.shading)), 1, 1e-5) << odd;
      const float covered = scalar.coverage_at(at.triangle, at.b1, at.b2);
      ASSERT_TRUE(covered >= 0 && covered <= 1) << odd;
    }
  }
}

constexpr uint32_t kGroups = 128, kPlaces = 64 * kGroups;

class OnDevice {
 public:
  explicit OnDevice(const Both& both)
      : materials_(device_, both.tables.materials), kernel_(bound(both.tables, both.curves)) {}

  // Number of words that differ from those of C++.
  size_t differences(const SurfaceTables& tables, const shader::Curves& curves) {
    device_.run([&](gpu::Commands& c) {
      c.dispatch(kernel_, gpu::push(SurfaceHeap::kTriangles), kGroups);
    });
    const auto theirs = words_.download<uint32_t>(size_t{kPlaces} * shader::kWordsOfPlace);
    const shader::SurfaceWords scalar(tables, curves);
    size_t n = 0;
    for (uint32_t i = 0; i < kPlaces; ++i) {
      const auto mine = scalar.words_of_place(i, SurfaceHeap::kTriangles);
      for (uint32_t k = 0; k < shader::kWordsOfPlace; ++k)
        n += mine.words[k] != theirs[i * shader::kWordsOfPlace + k];
    }
    return n;
  }

 private:
  gpu::Kernel bound(const SurfaceTables& t, const shader::Curves& curves) const {
    return {
        device_,
        shader::surface_test_spv,
        {gpu::Buffer(device_, t.faces), gpu::Buffer(device_, t.face_corners),
         gpu::Buffer(device_, t.corner_attributes), materials_, gpu::Buffer(device_, t.maps),
         gpu::Buffer(device_, t.texel_words), gpu::Buffer(device_, curves.surface),
         gpu::Buffer(device_, t.coverage.coverage_of), gpu::Buffer(device_, t.coverage.coverages),
         gpu::Buffer(device_, t.material_maps), words_, gpu::Buffer(device_, curves.sheen)},
        4};
  }

  gpu::Device device_ = gpu::Device::open();
  gpu::Buffer words_{device_, 4ull * kPlaces* shader::kWordsOfPlace};
  gpu::Buffer materials_;
  gpu::Kernel kernel_;
};

TEST(float_surface, of_a_device_are_those_of_the_cpu) {
  Both both;
  OnDevice device(both);
  EXPECT_EQ(device.differences(both.tables, both.curves), 0u);
  // One wrong bit in a material is detected.
  float& red = both.tables.materials[8].base_color.x;
  red = std::nextafter(red, 2.0f);
  EXPECT_GT(device.differences(both.tables, both.curves), 0u);
}

}  // namespace tdpt::float_surface_test
