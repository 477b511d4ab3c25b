// The light of skies and suns where it is known in closed form: by every integrator, with and
// without portals.
#include <gtest/gtest.h>

#include <functional>

#include "libcommon/testing/statistics/power.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/sky.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::sky_light_test {

using std::numbers::pi;

/// Objects made of quads, in a frame whose unit is the metre.
class Outdoors {
 public:
  Outdoors() { scene_.frame = {}; }

  uint32_t diffuse(float albedo) {
    Material m;
    m.base_color = Rgb(albedo);
    scene_.materials.push_back(m);
    return static_cast<uint32_t>(scene_.materials.size() - 1);
  }
  uint32_t material(const Material& m) {
    scene_.materials.push_back(m);
    return static_cast<uint32_t>(scene_.materials.size() - 1);
  }
  /// Parallelogram p, p+u, p+u+v, p+v; its front towards cross(u, v).
  void quad(const Vec3d& p, const Vec3d& u, const Vec3d& v, uint32_t material) {
    const auto first = static_cast<uint32_t>(scene_.positions.size());
    for (const Vec3d& corner : {p, p + u, p + u + v, p + v})
      scene_.positions.push_back(Vec3f(corner));
    scene_.triangles.push_back({{first, first + 1, first + 2}, material});
    scene_.triangles.push_back({{first, first + 2, first + 3}, material});
  }
  /// Closed, facing outwards, with these half sides.
  void box(const Vec3d& c, const Vec3d& h, uint32_t material) {
    const Vec3d x{2 * h.x, 0, 0}, y{0, 2 * h.y, 0}, z{0, 0, 2 * h.z};
    quad(c - h, y, x, material), quad(c - h, x, z, material), quad(c - h, z, y, material);
    quad(c + h, -x, -y, material), quad(c + h, -z, -x, material), quad(c + h, -y, -z, material);
  }
  void look(const Vec3d& from, const Vec3d& at, double yfov) {
    Camera c;
    c.position = from;
    c.forward = normalize(at - from);
    c.right = normalize(
        cross(c.forward, std::abs(c.forward.y) > 0.99 ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0)));
    c.up = cross(c.right, c.forward);
    c.yfov = yfov;
    scene_.cameras = {c};
  }
  /// 8 x 6 pixels.
  Vista vista(std::shared_ptr<const Sky> sky, const std::vector<Portal>& portals = {}) {
    scene_.sky = std::move(sky);
    return Vista(scene_, scene_.cameras[0], 8, 6, portals);
  }

  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

struct Measured {
  std::vector<double> mean, error;  ///< of the quarters of the picture, and of the whole
  /// Of the quarter with the largest deviation.
  double z(const std::vector<double>& expected) const {
    double worst = 0;
    for (size_t i = 0; i < mean.size(); ++i)
      worst = std::max(worst, std::abs(mean[i] - expected[i]) /
                                  std::hypot(error[i], 1e-5 * expected[i] + 1e-12));
    return worst;
  }
};

/// Means of the quarters of a picture of that many pixels, and of the whole.
template <class Value>
std::vector<double> quarters(int width, int height, const Value& value) {
  std::vector<double> sums(5);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double v = value(x, y) / (width * height);
      sums[static_cast<size_t>(2 * (2 * y / height) + 2 * x / width)] += 4 * v;
      sums[4] += v;
    }
  return sums;
}

Measured measured(const Vista& vista, const Integrator& integrator, uint64_t spp,
                  int max_depth = kMaxDepth, double beta = 1) {
  constexpr uint64_t kRuns = 12;
  std::vector<double> sum(5), squares(5);
  for (uint64_t seed = 1; seed <= kRuns; ++seed) {
    Job settings;
    settings.limits.spp = spp, settings.seed = testing::fresh(seed), settings.max_depth = max_depth,
    settings.beta = beta;
    const RenderResult r = render(*renderer_under_test(vista), integrator, settings);
    EXPECT_EQ(r.tally.not_finite, 0u) << integrator.name;
    const int width = vista.view.film.width();
    const std::vector<double> q = quarters(width, vista.view.film.height(), [&](int x, int y) {
      return luminance(r.picture.pixels[static_cast<size_t>(y * width + x)]);
    });
    for (size_t i = 0; i < 5; ++i) sum[i] += q[i], squares[i] += q[i] * q[i];
  }
  Measured m;
  for (size_t i = 0; i < 5; ++i) {
    m.mean.push_back(sum[i] / kRuns);
    const double variance = std::max(0.0, squares[i] / kRuns - m.mean[i] * m.mean[i]);
    m.error.push_back(std::sqrt(variance / (kRuns - 1)));
  }
  return m;
}

/// Student's t with 11 degrees of freedom, the worst of 5: exceeded in one of 10 000.
constexpr double kRight = 7;

struct Expectation {
  std::vector<double> quarters;
  uint64_t spp = 8;
  int max_depth = kMaxDepth;
  double error = 0.02;  ///< relative, of the whole picture, at most
};

/// pt, which portals do not change, only without portals and if the sun is large enough to be hit.
void expect_shown(const char* what, const Vista& vista, const Expectation& e, bool with_pt = true) {
  for (const Integrator* integrator : integrators_under_test()) {
    if (integrator == &pt && (!with_pt || !vista.openings.portals.empty())) continue;
    const Measured m = measured(vista, *integrator, e.spp, e.max_depth);
    std::printf("%-24s %-11s %9.5f +- %.5f, known %.5f, worst z %.2f\n", what, integrator->name,
                m.mean[4], m.error[4], e.quarters[4], m.z(e.quarters));
    EXPECT_LT(m.z(e.quarters), kRight) << what << ", " << integrator->name;
    EXPECT_LE(m.error[4], e.error * e.quarters[4]) << what << ", " << integrator->name;
  }
}

std::vector<double> alike(double value) {
  return std::vector<double>(5, value);
}

// A convex body of albedo a under a sky of radiance 1 shows a.
TEST(sky_light, a_box_under_a_sky_of_1_shows_its_albedo) {
  Outdoors out;
  out.box({0, 0, 0}, {1, 0.5, 0.7}, out.diffuse(0.9f));
  out.look({0.4, 3, 2.2}, {0, 0.5, 0.1}, 0.2);
  const Expectation expected{alike(double{0.9f})};
  expect_shown("box", out.vista(one_colour_sky(Rgb(1))), expected);
  // Light comes down through one portal over the box, and a slanting one.
  const Portal over = rectangle({-1, 0.8, -1}, {2, 0, 0}, {0, 0, 2});
  const Portal slanting = rectangle({-0.3, 0.6, -0.3}, {0.9, 0.3, 0}, {0, 0, 0.9});
  expect_shown("box, portals", out.vista(one_colour_sky(Rgb(1)), {over, slanting}), expected);
}

// Without absorption everything is as bright as the sky, on any path.
TEST(sky_light, a_white_alcove_is_as_bright_as_the_sky) {
  Outdoors out;
  const uint32_t white = out.diffuse(1);
  out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white);
  out.quad({-1, 1.5, -1}, {2, 0, 0}, {0, 0, 2}, white);
  out.quad({-1, 0, 1}, {0, 1.5, 0}, {2, 0, 0}, white);
  out.quad({-1, 0, -1}, {2, 0, 0}, {0, 1.5, 0}, white);
  out.quad({-1, 0, -1}, {0, 1.5, 0}, {0, 0, 2}, white);
  out.look({0.8, 1.2, 0.7}, {-0.6, 0.3, -0.5}, 0.7);
  const Portal open = rectangle({1, 0, -1}, {0, 0, 2}, {0, 1.5, 0});
  const Portal half = rectangle({0.7, 0.4, -0.9}, {0, 0, 1}, {0.2, 1, 0});
  for (const auto& portals : {std::vector<Portal>{}, {open}, {half}})
    expect_shown("alcove", out.vista(one_colour_sky(Rgb(1)), portals),
                 {.quarters = alike(1), .spp = 32, .error = kByScalar ? 0.12 : 0.06});
}

// A thin pane, a veil of alpha 1/2, a mirror and a block of clear glass in the open.
TEST(sky_light, what_neither_absorbs_nor_glows_cannot_be_seen_under_a_sky_of_1) {
  Outdoors out;
  Material glass = clear_pane();
  glass.solid = true;
  Material mirror;
  mirror.plain = false;
  mirror.base_color = Rgb(1), mirror.metallic = 1, mirror.roughness = 0;
  Material half = veil(0.5f);
  half.base_color = Rgb(1);
  out.box({-0.5, 0.3, 0}, {0.25, 0.3, 0.3}, out.material(glass));
  out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, out.material(mirror));
  out.quad({0.1, 0.05, 0.2}, {0.6, 0, 0.1}, {0, 0.8, 0.1}, out.material(clear_pane()));
  out.quad({0.4, 0.05, -0.4}, {0.5, 0, 0.3}, {0, 0.9, 0}, out.material(half));
  out.look({0.3, 0.8, 1.4}, {0, 0.35, 0}, 0.9);
  const Portal over = rectangle({-1, 0.95, -1}, {2, 0, 0}, {0, 0, 2});
  expect_shown("clear things", out.vista(one_colour_sky(Rgb(1))),
               {.quarters = alike(1), .spp = 16});
  expect_shown("clear things, portal", out.vista(one_colour_sky(Rgb(1)), {over}),
               {.quarters = alike(1), .spp = 16});
}

// A black room under a ceiling with a square hole.
struct HoleInTheCeiling {
  static constexpr double kHigh = 0.9;
  static constexpr float kAlbedo = 0.5f;

  /// `half` of the hole's side [m].
  explicit HoleInTheCeiling(double half = 0.3) : h(half) {
    const uint32_t black = out.diffuse(0), floor = out.diffuse(kAlbedo);
    out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, floor);
    out.quad({-1, 0, 1}, {0, kHigh, 0}, {2, 0, 0}, black);
    out.quad({-1, 0, -1}, {2, 0, 0}, {0, kHigh, 0}, black);
    out.quad({-1, 0, -1}, {0, kHigh, 0}, {0, 0, 2}, black);
    out.quad({1, 0, -1}, {0, 0, 2}, {0, kHigh, 0}, black);
    out.quad({-1, kHigh, -1}, {2, 0, 0}, {0, 0, 1 - h}, black);
    out.quad({-1, kHigh, h}, {2, 0, 0}, {0, 0, 1 - h}, black);
    out.quad({-1, kHigh, -h}, {1 - h, 0, 0}, {0, 0, 2 * h}, black);
    out.quad({h, kHigh, -h}, {1 - h, 0, 0}, {0, 0, 2 * h}, black);
    out.look({-0.4, 0.85, 0.3}, {0.1, 0, -0.1}, 0.5);
  }
  Portal hole() const {  // down, in the ceiling's plane
    return rectangle({-h, kHigh, -h}, {2 * h, 0, 0}, {0, 0, 2 * h});
  }
  /// Radiance of the floor under a sky of 1. The hole's projected solid angle by Lambert's formula
  /// for polygons: half the sum of the angles subtended by its edges, each times the cosine between
  /// the normals of the floor and of the edge's plane.
  double floor_at(double x, double z) const {
    const Vec3d at(x, 0, z);
    const Vec3d corner[4] = {{-h, kHigh, -h}, {h, kHigh, -h}, {h, kHigh, h}, {-h, kHigh, h}};
    double sum = 0;
    for (size_t i = 0; i < 4; ++i) {
      const Vec3d a = normalize(corner[i] - at), b = normalize(corner[(i + 1) % 4] - at);
      sum += 0.5 * std::acos(dot(a, b)) * normalize(cross(a, b)).y;
    }
    return kAlbedo / pi * std::abs(sum);
  }
  /// Expected quarters of the picture under a sky of 1.
  std::vector<double> shown(const Vista& vista) const {
    return shown(vista, [this](double x, double z) { return floor_at(x, z); });
  }
  /// The same if the floor shows `radiance(x, z)`.
  std::vector<double> shown(const Vista& vista,
                            const std::function<double(double, double)>& radiance) const {
    constexpr int kFine = 96;
    const int width = vista.view.film.width() * kFine, height = vista.view.film.height() * kFine;
    double furthest = 0;
    const auto all = quarters(width, height, [&](int x, int y) {
      const Vec3d w = vista.view.film.direction((x + 0.5) / kFine, (y + 0.5) / kFine);
      const Vec3d o = vista.view.film.position();
      const Vec3d at = o - w * (o.y / w.y);
      furthest = std::max({furthest, std::abs(at.x), std::abs(at.z)});
      return radiance(at.x, at.z);
    });
    EXPECT_LT(furthest, 1);  // the floor fills the picture
    return all;
  }

  double h;
  Outdoors out;
};

TEST(sky_light, of_one_colour_through_a_square_hole_is_the_holes_form_factor) {
  HoleInTheCeiling room;
  // Half of it, and one that faces up.
  Portal half = rectangle({-0.3, 0.9, -0.3}, {0.3, 0, 0}, {0, 0, 0.6}), wrong = room.hole();
  for (auto& t : wrong.triangles) std::swap(t[1], t[2]);
  for (const auto& [what, portals] : {std::pair<const char*, std::vector<Portal>>{"hole", {}},
                                      {"hole, portal", {room.hole()}},
                                      {"hole, half a portal", {half}},
                                      {"hole, portal facing up", {wrong}}}) {
    const Vista vista = room.out.vista(one_colour_sky(Rgb(1)), portals);
    const auto expected = room.shown(vista);
    expect_shown(what, vista, {expected, 192, 2, 0.04});
  }
}

// Parallel light of E = L pi sin^2(half angle) falls through the hole; the floor shows a / pi E cos
// where the whole disc is seen.
TEST(sky_light, of_a_sun_through_a_hole_falls_where_it_should) {
  HoleInTheCeiling room;
  const Vec3d towards = normalize(Vec3d(-0.2, 1, 0.15));
  const double half_angle = 0.25 * kDegree;
  const Sky::Sun sun = sun_of(towards, half_angle, 3);
  const auto sky = std::make_shared<Sky>(Sky::Map{}, 0, std::vector{sun});
  const auto lit = [&](double x, double z) {
    const double up = HoleInTheCeiling::kHigh / towards.y;
    const bool inside =
        std::abs(x + towards.x * up) < room.h && std::abs(z + towards.z * up) < room.h;
    return inside ? HoleInTheCeiling::kAlbedo / pi * 3 * towards.y : 0;
  };
  for (const auto& portals : {std::vector<Portal>{}, {room.hole()}}) {
    const Vista vista = room.out.vista(sky, portals);
    expect_shown(portals.empty() ? "sun" : "sun, portal", vista,
                 {room.shown(vista, lit), 64, 2, 0.01}, false);
  }
}

#ifndef TDPT_BY_SCALAR  // of the CPU's densities
// Twins: densities that are 5 % too large.
TEST(sky_light, twin_a_sky_off_by_5_percent_is_caught) {
  HoleInTheCeiling room;
  const Sky::Sun sun = sun_of({-0.2, 1, 0.15}, 0.25 * kDegree, 3);
  Vista vista =
      room.out.vista(std::make_shared<Sky>(Sky::Map{}, 0, std::vector{sun}), {room.hole()});
  for (const Integrator* integrator : {&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided}) {
    const Measured m = measured(vista, *integrator, 192, 2);
    LightsFaults::scale_sky(vista.openings.selection, 1.05);
    const Measured spoilt = measured(vista, *integrator, 192, 2);
    LightsFaults::scale_sky(vista.openings.selection, 1 / 1.05);
    std::printf("twin, sky %-11s z %.1f\n", integrator->name, spoilt.z(m.mean));
    EXPECT_GT(spoilt.z(m.mean), 2 * kRight) << integrator->name;
  }
}
#endif
TEST(sky_light, twin_a_portal_off_by_5_percent_is_caught) {
  HoleInTheCeiling room(0.1);
  Vista vista = room.out.vista(one_colour_sky(Rgb(1)), {room.hole()});
  const auto expected = room.shown(vista);
  vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, 1.05);
  for (const Integrator* integrator : {&tdpt_org, &tdpt_ref}) {
    const Measured spoilt = measured(vista, *integrator, 512, 2);
    std::printf("twin, portal %-11s z %.1f\n", integrator->name, spoilt.z(expected));
    EXPECT_GT(spoilt.z(expected), 2 * kRight) << integrator->name;
  }
}

// One texel of 1e6 in a black map over a floor: row 4 of 16, column 20 of 32. Its radiance falls to
// 0 at the centres of its neighbours, linearly in azimuth and in y, the floor's cosine: the mean of
// a triangle over y is at the mean of its corners.
TEST(sky_light, of_one_texel_of_a_million_is_its_projected_solid_angle) {
  Outdoors out;
  out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, out.diffuse(0.5f));
  out.look({0, 2, 0.5}, {0, 0, 0}, 0.3);
  Sky::Map map{32, 16, std::vector<Rgb>(32 * 16)};
  map.texels[4 * 32 + 20] = Rgb(1e6f);
  const double below = std::cos(5.5 * pi / 16), at = std::cos(4.5 * pi / 16),
               above = std::cos(3.5 * pi / 16);
  const double irradiance = 1e6 * (2 * pi / 32) * (above - below) / 2 * (above + at + below) / 3;
  const auto sky = std::make_shared<Sky>(map, 0);
  for (const auto& portals :
       {std::vector<Portal>{}, {rectangle({-0.7, 0.5, -0.7}, {1.4, 0, 0}, {0, 0, 1.4})}})
    expect_shown(portals.empty() ? "texel" : "texel, portal", out.vista(sky, portals),
                 {alike(0.5 / pi * irradiance), 64, kMaxDepth, 0.02}, false);
}

// A texel at three quarters of the width and half the height is at +x: it lights walls that face
// +x, not those that face -x or, by a hundredth, up.
TEST(sky_light, comes_from_where_the_map_has_it) {
  Sky::Map map{64, 32, std::vector<Rgb>(64 * 32)};
  for (const size_t texel : {15 * 64 + 47, 15 * 64 + 48, 16 * 64 + 47, 16 * 64 + 48})
    map.texels[texel] = Rgb(100);
  const auto lit = [&](double rotation, const Vec3d& facing) {
    Outdoors out;
    const Onb<double> onb(facing);
    out.quad(-onb.x - onb.y, onb.x * 2, onb.y * 2, out.diffuse(0.5f));
    out.look(facing * 4, {0, 0, 0}, 0.3);
    return measured(out.vista(std::make_shared<Sky>(map, rotation)), nee, 16, 2).mean[4];
  };
  // Twice the step of the map in azimuth and elevation: 0.196 x 0.196 sr.
  const double full = 0.5 / pi * 100 * std::pow(2 * pi / 32, 2);
  EXPECT_NEAR(lit(0, {1, 0, 0}) / full, 1, 0.02);
  EXPECT_EQ(lit(0, {-1, 0, 0}), 0);
  EXPECT_LT(lit(0, {0, 1, 0}), 0.05 * full);
  // Turned by 90 degrees counter-clockwise, seen from above: from +x to -z.
  EXPECT_NEAR(lit(90 * kDegree, {0, 0, -1}) / full, 1, 0.02);
  EXPECT_EQ(lit(90 * kDegree, {0, 0, 1}), 0);
}

// Seen directly, the map is exact, and so is a sun beside it however small and bright, by every
// integrator.
TEST(sky_light, is_seen_as_it_is) {
  Outdoors out;
  out.box({0, -3, 0}, {0.5, 0.5, 0.5}, out.diffuse(0.5f));
  const Vec3d towards = normalize(Vec3d(0.3, 0.4, -1));
  out.look({0, 0, 0}, towards, 0.1);
  Sky::Map map = uneven_map();
  for (Rgb& texel : map.texels) texel *= 1e6f;
  for (const double half_angle : {0.25 * kDegree, 1e-4}) {
    const auto sky = std::make_shared<Sky>(map, 0.3, std::vector{sun_of(towards, half_angle, 5)});
    const Vista vista = out.vista(sky, {rectangle({-1, -1, -1}, {0, 0, 2}, {2, 0, 0})});
    const Vec3d corner = vista.view.film.direction(0.5, 0.5);
    for (const Integrator* integrator : integrators_under_test()) {
      Job settings;
      settings.limits.spp = 64;
      const RenderResult r = render(*renderer_under_test(vista), *integrator, settings);
      EXPECT_EQ(r.tally.not_finite, 0u);
      EXPECT_NEAR(luminance(r.picture.pixels[0]) / luminance(sky->radiance(corner)), 1, 0.01)
          << integrator->name;
    }
    // The sun's disc.
    out.look({0, 0, 0}, towards, half_angle / 4);
    const Vista close = out.vista(sky);
    for (const Integrator* integrator : integrators_under_test()) {
      const Measured m = measured(close, *integrator, 1);
      EXPECT_NEAR(m.mean[4] / luminance(sky->radiance(towards)), 1, 1e-3) << integrator->name;
    }
    out.look({0, 0, 0}, towards, 0.1);
  }
}

// No ray finds its way into a closed box, wherever portals and camera are.
TEST(sky_light, does_not_get_into_a_closed_box) {
  Scene scene = without_lamps(read_gltf(furnace_path()));
  scene.sky = one_colour_sky(Rgb(1000));
  const std::vector<std::vector<Portal>> sets{
      {},
      {portal_in_the_furnace()},
      {rectangle({1, 0, -1}, {0, 0, 2}, {0, 2, 0})},        // in a wall
      {rectangle({1.00001, 0, -1}, {0, 0, 2}, {0, 2, 0})},  // behind it
      {rectangle({-3, 1, -3}, {6, 0, 0}, {0, 0, 6})}};      // through all of them
  for (const auto& portals : sets) {
    const Vista vista(scene, scene.camera(""), 8, 6, portals);
    for (const Integrator* integrator : integrators_under_test())
      EXPECT_EQ(measured(vista, *integrator, 24, 32).mean[4], 0) << integrator->name;
  }
}

}  // namespace tdpt::sky_light_test
