// Weights of hand-built paths that no sampler would ever find.
#include <gtest/gtest.h>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/oracle.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::path_by_hand_test {

Walk walk_of(int size) {
  Walk walk;
  for (; walk.size < size; ++walk.size) walk.make_place();
  return walk;
}

// Between two plates 1e-7 apart, alternately straight across and along: the density of every
// strategy is thousands of orders of magnitude below the common factor.
TEST(paths_by_hand, weights_survive_products_that_no_double_holds) {
  const Scene scene = diffuse_rooms();
  const Vista vista(scene, scene.camera(""), 16, 12, {});
  uint32_t lamp = 0;
  while (max_component(scene.material_of(lamp).emission) <= 0) ++lamp;
  Material grey;
  grey.base_color = Rgb(1);  // walks always survive
  const int k = 1000;
  Walk y = walk_of(1), z = walk_of(k);
  const Vec3d across = vista.view.film.forward();  // the camera sees x_{k-1} on its front
  const Vec3d along = normalize(cross(across, Vec3d(0, 1, 0)));
  const auto place = [&](int i, Vertex& v) {
    v.position = vista.view.film.position() + across * (0.3 + 1e-7 * (i % 2)) +
                 along * (0.01 * (i / 2 - (k - 1) / 2));
    v.normal = across * (i % 2 ? -1 : 1);
    v.material = &grey;
    v.color = grey.base_color;
  };
  place(0, y.v[0]);
  y.v[0].material = &scene.material_of(lamp);
  y.v[0].triangle = lamp;
  y.v[0].source = &vista.world->lights.surface(false);
  y.states[0].pdf_own_A = vista.openings.selection.pdf_A(lamp);
  z.film = &vista.view.film;
  z.v[0].position = vista.view.film.position();
  for (int j = 1; j < k; ++j) place(k - j, z.v[static_cast<size_t>(j)]);
  const auto at = [&](int i) -> const Vertex& { return i == 0 ? y[0] : z[k - i]; };
  const auto scattered = [](const Vertex& from, const Vertex& v, const Vertex& to) {
    return scatter_pdf_A(v, Incidence(v, between(v, from).w), between(v, to), to, false);
  };
  for (int i = 0; i < k; ++i) {
    const Vertex& v = at(i);
    const Edge from_camera = between(at(k), at(i));
    const double camera = i == k - 1 ? to_area(vista.view.film.pdf_w(from_camera.w), from_camera, v)
                                     : scattered(at(i + 2), at(i + 1), v);
    const double light = i == 0   ? y.state(0).pdf_own_A
                         : i == 1 ? emission_pdf_A(at(0), between(at(0), v), v)
                                  : scattered(at(i - 2), at(i - 1), v);
    WalkState& state = z.states[static_cast<size_t>(k - i)];
    if (i == 0) continue;
    state.edge = between(z[k - i - 1], z[k - i]);
    state.pdf_own_A = camera, state.pdf_other_A = light;
  }
  RayCounts rays;
  const Guide guide(vista, tdpt_org.mixture);
  const Path path(vista, guide, y, 1, z, k, rays);
  const auto p = oracle::densities(vista, path, bdpt.mixture);
  double largest = -1e300;
  for (const auto& d : p) largest = std::max(largest, d.log_p);
  for (const double beta : {1, 2}) {
    double sum = 0, twin = 0;
    int told = 0;
    for (const auto& d : p) {
      const double w = path.weight(bdpt.mixture, d.strategy, beta);
      const double expected = oracle::weight(p, d.strategy, beta);
      EXPECT_NEAR(w, expected, 1e-9);
      if (expected > 1e-250) {
        EXPECT_NEAR(w / expected, 1, 1e-6);
        twin = std::max(twin, std::abs(w / oracle::weight(p, d.strategy, beta * 1.05) - 1));
        ++told;
      }
      sum += w;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_GT(twin, 0.1);  // an exponent off by 5 %
    EXPECT_GT(told, 10);
  }
  double common = 0;  // logarithm of the divisor in the product form
  for (int i = 0; i < k; ++i)
    common += std::log(i == 0 ? y.state(0).pdf_own_A
                              : z.state(k - i).pdf_own_A + z.state(k - i).pdf_other_A);
  EXPECT_LT(largest - common, -750);  // below the smallest double, exp(-745)
}

// x_0 on a lamp, then x_1, x_2, x_3, and the camera. Neither x_1 nor x_3 can scatter towards x_2:
// only the portal segments that end there, x_1 -> x_2 and x_2 -> x_3, have a density.
TEST(paths_by_hand, a_vertex_that_no_walk_can_have_made_leaves_the_weights_of_segments) {
  const Scene scene = diffuse_rooms();
  const FilmPlane seen_by(scene.camera(""), 16, 12);
  const Vec3d forward = seen_by.forward();
  const Vec3d side = normalize(cross(forward, Vec3d(0, 1, 0)));
  const Vec3d x4 = seen_by.position(), x3 = x4 + forward * 0.3;
  const Vec3d x2 = x3 + forward * 0.2 + side * 0.05, x1 = x2 + side * 0.2;
  const Vec3d x0 = x1 + forward * 0.1 + side * 0.15;
  // A square about the middle of an edge, perpendicular to it.
  const auto between_ends = [&](const Vec3d& from, const Vec3d& to, double size) {
    const Vec3d u = normalize(cross(to - from, Vec3d(0.1, 1, 0.2))) * size;
    const Vec3d v = normalize(cross(to - from, u)) * size;
    const Vec3d corner = (from + to) / 2 - u / 2 - v / 2;
    const auto metres = [&](const Vec3d& p) { return scene.frame.to_metres(p); };
    return rectangle(metres(corner), metres(corner + u) - metres(corner),
                     metres(corner + v) - metres(corner));
  };
  const Vista vista(scene, scene.camera(""), 16, 12,
                    {between_ends(x1, x2, 0.04), between_ends(x2, x3, 0.05)});
  uint32_t lamp = 0;
  while (max_component(scene.material_of(lamp).emission) <= 0) ++lamp;
  Material grey;
  const auto vertex = [&](const Vec3d& position, const Vec3d& normal) {
    Vertex v;
    v.position = position;
    v.normal = normalize(normal);
    v.material = &grey;
    v.color = grey.base_color;
    return v;
  };
  Walk y = walk_of(1), z = walk_of(2);
  y.v[0] = vertex(x0, x1 - x0);
  y.v[0].material = &scene.material_of(lamp);
  y.v[0].triangle = lamp;
  y.v[0].source = &vista.world->lights.surface(false);
  y.states[0].pdf_own_A = vista.openings.selection.pdf_A(lamp);
  z.film = &vista.view.film;
  z.v[0].position = x4;
  z.v[1] = vertex(x3, -forward);  // x_2 is behind it
  const Edge film = between(z[0], z[1]);
  z.states[1].edge = film;
  z.states[1].pdf_own_A = to_area(vista.view.film.pdf_w(film.w), film, z[1]);
  const Vertex end_1 = vertex(x1, side);  // x_2 is behind it, x_0 in front
  const Vertex end_2 = vertex(x2, side - forward);
  RayCounts rays;
  const Guide guide(vista, tdpt_org.mixture);
  const SegmentCrossings crossings{guide.crossing(end_1, end_2, rays.portal),
                                   guide.crossing(y[0], end_1, rays.portal),
                                   guide.crossing(end_2, z[1], rays.portal)};
  const Path path(vista, guide, y, 1, end_1, end_2, crossings, z, 2, rays);
  for (const double beta : {1, 2}) {
    const auto p = oracle::densities(vista, path, tdpt_org.mixture);
    double sum = 0;
    for (const auto& d : p) {
      const double w = path.weight(tdpt_org.mixture, d.strategy, beta);
      if (d.strategy.technique == Technique::portal && d.strategy.split > 0) {
        EXPECT_NEAR(w, oracle::weight(p, d.strategy, beta), 1e-9);
        EXPECT_GT(std::abs(w - oracle::weight(p, d.strategy, beta * 1.05)), 1e-3);  // twin
        sum += w;
      } else {
        EXPECT_EQ(d.log_p, -HUGE_VAL);
        EXPECT_TRUE(std::isnan(w)) << kTechniqueNames[static_cast<size_t>(d.strategy.technique)];
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

}  // namespace tdpt::path_by_hand_test
