// Next events at rectangular lights have the claimed density, wherever they are made.
#include <gtest/gtest.h>

#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/rect_lights.h"

namespace tdpt::rect_lights_test {

constexpr double kRight = 1e-4, kWrong = 1e-9;
constexpr uint64_t kSamples = 30000;
constexpr size_t kLattice = 4, kBins = kLattice * kLattice;

struct Shaded {
  Vec3d place, normal;  // [m]
  bool both_ways = false;
};

class Rooms {
 public:
  Rooms()
      : scene_(with_rect_lights(diffuse_rooms())), vista_(scene_, scene_.camera(""), 4, 4, {}) {}
  const Vista& vista() const { return vista_; }
  const std::vector<RectLight>& rect_lights() const { return vista_.world->rect_lights; }

  Vertex vertex(const Shaded& shaded) const {
    Vertex v;
    v.position = scene_.frame.to_canonical(shaded.place);
    v.normal = v.shading = normalize(shaded.normal);
    v.material = &scene_.materials[0];
    v.simple = !shaded.both_ways;
    if (shaded.both_ways) v.bsdf.through = Rgb(0.5f);
    vista_.next_events().look_out(v.normal, v);
    return v;
  }
  double density(const Vertex& v, const RectLight& rect_light, double x, double y) const {
    Vertex light;
    light.source = rect_light.source;
    light.triangle = x < y ? rect_light.triangle1 : rect_light.triangle0;
    light.position = rect_light.corner + rect_light.x * (x * rect_light.length_x) +
                     rect_light.y * (y * rect_light.length_y);
    return vista_.next_events().pdf(v, light).of(0);
  }

 private:
  Scene scene_;
  Vista vista_;
};

size_t part(double x) {
  return std::min(static_cast<size_t>(std::max(x, 0.0) * kLattice), kLattice - 1);
}

// `claimed`: the point that the density is evaluated for.
double next_events(const Shaded& shaded, const Shaded& claimed) {
  const Rooms rooms;
  Vertex v = rooms.vertex(shaded);
  const Vertex other = rooms.vertex(claimed);
  std::vector<double> probability;
  for (const RectLight& rect_light : rooms.rect_lights())
    for (size_t i = 0; i < kLattice; ++i)
      for (size_t j = 0; j < kLattice; ++j) {
        const auto at = [](size_t k) { return static_cast<double>(k) / kLattice; };
        probability.push_back(
            rect_light.length_x * rect_light.length_y *
            integrate([&](double x, double y) { return rooms.density(other, rect_light, x, y); },
                      at(i), at(i + 1), at(j), at(j + 1)));
      }
  double sum = 0;
  for (const double p : probability) sum += p;
  EXPECT_NEAR(sum, 1, 1e-3);
  const auto draw = [&](uint64_t i) {
    Rng rng(61, 0, i);
    const double pick = rng.uniform();
    const double a = rng.uniform();
    const double b = rng.uniform();
    const double side = rng.uniform();
    const Lights::Point p = rooms.vista().next_events().sample(v, 0, pick, a, b, side);
    for (size_t k = 0; k < rooms.rect_lights().size(); ++k) {
      const RectLight& rect_light = rooms.rect_lights()[k];
      if (p.triangle != rect_light.triangle0 && p.triangle != rect_light.triangle1) continue;
      const TriangleShape& shape = rooms.vista().world->tracer.shape(p.triangle);
      EXPECT_LT(length(shape.p0 + shape.e1 * p.b1 + shape.e2 * p.b2 - p.position), 1e-6);
      const double x = dot(rect_light.x, p.position - rect_light.corner) / rect_light.length_x;
      const double y = dot(rect_light.y, p.position - rect_light.corner) / rect_light.length_y;
      EXPECT_NEAR(p.pdf / rooms.density(v, rect_light, x, y), 1, 1e-6);
      return k * kBins + part(x) * kLattice + part(y);
    }
    return probability.size();
  };
  return chi_square_of_samples(kSamples, probability, draw).p;
}

const std::vector<Shaded> kShaded{
    {{1.0, 0.0, 0.0}, {0, 1, 0}},              // the floor
    {{1.9, 0.3, 0.8}, {-1, 0.3, -0.2}},        // sees some of each
    {{0.2, 0.4, -0.3}, {0.1, 1, 0.2}},         // in front of one that its horizon cuts
    {{0.051, 0.6, -0.1}, {1, 0, 0}, true},     // a millimetre in front of it
    {{1.3, 1.3, 0.25}, {0.3, -1, 0.1}, true},  // translucent, between all of them
    {{3.5, 0.5, 0.1}, {0, 1, 0}},              // in the lamp's room
};

TEST(rect_lights, next_events_have_their_density_everywhere) {
  for (const Shaded& shaded : kShaded) EXPECT_GT(next_events(shaded, shaded), kRight);
}
TEST(rect_lights, twin_densities_of_another_horizon_or_place_are_caught) {
  Shaded tilted = kShaded[1], beside = kShaded[0];
  tilted.normal.y += 0.2;
  EXPECT_LT(next_events(kShaded[1], tilted), kWrong);
  beside.place.x += 0.1;
  EXPECT_LT(next_events(kShaded[0], beside), kWrong);
}

TEST(rect_lights, those_that_send_nothing_are_not_chosen) {
  const Rooms rooms;
  for (const Shaded& dark : {Shaded{{0.01, 0.5, 0}, {-1, 0, 0}},     // behind the one in the wall
                             Shaded{{1.0, 2.5, 0.9}, {0, 1, 0}}}) {  // all below the horizon
    Vertex v = rooms.vertex(dark);
    const Lights::Point p = rooms.vista().next_events().sample(v, 0, 0.5, 0.5, 0.5, 0.5);
    EXPECT_EQ(p.source, nullptr);
    EXPECT_EQ(v.light_context.sent, 0);
    for (const RectLight& rect_light : rooms.rect_lights())
      EXPECT_EQ(rooms.density(v, rect_light, 0.4, 0.6), 0);
  }
}

// In its plane, on it, at its corner, a millionth of a metre in front of it.
TEST(rect_lights, densities_are_finite_at_the_extremes) {
  const Rooms rooms;
  for (const Vec3d& place :
       {Vec3d(0.05, 0.5, 0), Vec3d(0.050001, 0.5, 0), Vec3d(0.050001, 0.1, -0.5),
        Vec3d(0.05, 0.05, -0.7), Vec3d(0.0499999, 0.4, 0.1), Vec3d(0.5, 1.949999, -0.4)})
    for (const Vec3d& normal : {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(1, 1, 1)}) {
      Vertex v = rooms.vertex({place, normal});
      for (int i = 0; i < 100; ++i) {
        Rng rng(62, 0, static_cast<uint64_t>(i));
        const double pick = rng.uniform();
        const double a = rng.uniform();
        const double b = rng.uniform();
        const Lights::Point p = rooms.vista().next_events().sample(v, 0, pick, a, b, 0.5);
        if (!p.source) continue;
        EXPECT_TRUE(std::isfinite(p.pdf) && p.pdf > 0) << p.pdf;
        EXPECT_TRUE(is_finite(p.position));
      }
      for (const RectLight& rect_light : rooms.rect_lights())
        EXPECT_TRUE(std::isfinite(rooms.density(v, rect_light, 0.3, 0.3)));
    }
}

TEST(rect_lights, are_few_and_rectangles_or_there_are_none) {
  const auto number = [](const Scene& scene) {
    const Lights lights(scene);
    return rect_lights_of(scene, LightSelection(lights)).size();
  };
  EXPECT_EQ(number(diffuse_rooms()), 0u);  // one small lamp
  Scene scene = with_rect_lights(diffuse_rooms());
  EXPECT_EQ(number(scene), 4u);
  scene.triangles.back().vertex = {0, 1, 2};
  EXPECT_EQ(number(scene), 0u);
  for (const double size : {0.5, 4e-6}) {  // sheared, however small
    scene = diffuse_rooms();
    add_rect_light(scene, {0.5, 1.9, 0}, {size, 0, 0}, {0.5 * size, 0, size}, Rgb(1.0f));
    EXPECT_EQ(number(scene), 0u) << size;
  }
  scene = diffuse_rooms();
  for (size_t n = 2; n <= kMostRectLights + 1; ++n) {
    add_rect_light(scene, {0.2 * static_cast<double>(n), 1.9, 0}, {0.1, 0, 0}, {0, 0, 0.1},
                   Rgb(1.0f));
    EXPECT_EQ(number(scene), n <= kMostRectLights ? n : 0);
  }
}

}  // namespace tdpt::rect_lights_test
