// The light of skies and suns where it is known in closed form: by every integrator, with and
// without portals. pt knows the sky's without, and others agree with it [sky_agreement_test.cpp].
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/means.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/sky.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::sky_light_test {

/// Objects made of sheets, in a frame whose unit is the metre.
class Outdoors {
 public:
  /// Parallelogram p, p+u, p+u+v, p+v; its front towards cross(u, v).
  void quad(const Vec3d& p, const Vec3d& u, const Vec3d& v, const Material& material) {
    scene_ = with_sheet(std::move(scene_), material, p, u, v);
  }
  /// Closed, facing outwards, with these half sides.
  void box(const Vec3d& c, const Vec3d& h, const Material& m) {
    const Vec3d x{2 * h.x, 0, 0}, y{0, 2 * h.y, 0}, z{0, 0, 2 * h.z};
    quad(c - h, y, x, m), quad(c - h, x, z, m), quad(c - h, z, y, m);
    quad(c + h, -x, -y, m), quad(c + h, -z, -x, m), quad(c + h, -y, -z, m);
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

 private:
  Scene scene_;
};
Material diffuse(float albedo) {
  Material m;
  m.base_color = Rgb(albedo);
  return m;
}

/// pt, which portals do not change, only without portals and if the sun is large enough to be hit.
void expect_shown(const char* what, const Vista& vista, double expected, uint64_t spp,
                  int max_depth = kMaxDepth, bool with_pt = true) {
  for (const Integrator* integrator : integrators()) {
    if (integrator == &pt && (!with_pt || !vista.openings.portals.empty())) continue;
    const MeanAndError m = rendered(vista, *integrator, spp, 16, max_depth);
    EXPECT_LT(m.z(expected), 6) << what << ", " << integrator->name;
    EXPECT_LE(m.error, 0.02 * expected) << what << ", " << integrator->name;
  }
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
  out.box({-0.5, 0.3, 0}, {0.25, 0.3, 0.3}, glass);
  out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, mirror);
  out.quad({0.1, 0.05, 0.2}, {0.6, 0, 0.1}, {0, 0.8, 0.1}, clear_pane());
  out.quad({0.4, 0.05, -0.4}, {0.5, 0, 0.3}, {0, 0.9, 0}, half);
  out.look({0.3, 0.8, 1.4}, {0, 0.35, 0}, 0.9);
  const Portal over = rectangle({-1, 0.95, -1}, {2, 0, 0}, {0, 0, 2});
  for (const auto& portals : {std::vector<Portal>{}, {over}})
    expect_shown("clear things", out.vista(one_colour_sky(Rgb(1)), portals), 1, 16);
}

// A black room under a ceiling with a square hole, which parallel light of E = L pi sin^2(half
// angle) falls through: the floor shows a / pi E cos where the whole disc is seen. The picture cuts
// off a part of that.
struct SunThroughAHole {
  static constexpr double kHigh = 0.9, h = 0.3;  // of the ceiling; half the hole's side [m]
  const Vec3d towards = normalize(Vec3d(-0.2, 1, 0.15));
  Outdoors out;

  SunThroughAHole() {
    const Material black = diffuse(0);
    out.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, diffuse(0.5f));
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
  Vista vista(bool portal) {
    const auto sky =
        std::make_shared<Sky>(Sky::Map{}, 0, std::vector{sun_of(towards, 0.25 * kDegree, 3)});
    const Portal hole = rectangle({-h, kHigh, -h}, {2 * h, 0, 0}, {0, 0, 2 * h});  // down
    return out.vista(sky, portal ? std::vector{hole} : std::vector<Portal>{});
  }
  double expected(const Vista& vista) const {
    constexpr int kFine = 96;
    int lit = 0;
    for (int y = 0; y < 6 * kFine; ++y)
      for (int x = 0; x < 8 * kFine; ++x) {
        const Vec3d w = vista.view.film.direction((x + 0.5) / kFine, (y + 0.5) / kFine);
        const Vec3d o = vista.view.film.position();
        const Vec3d hole = o - w * (o.y / w.y) + towards * (kHigh / towards.y);
        lit += std::abs(hole.x) < h && std::abs(hole.z) < h;
      }
    return 0.5 * std::numbers::inv_pi * 3 * towards.y * lit / (48 * kFine * kFine);
  }
};

TEST(sky_light, of_a_sun_through_a_hole_falls_where_it_should) {
  SunThroughAHole room;
  for (const bool portal : {false, true}) {
    const Vista vista = room.vista(portal);
    expect_shown("sun", vista, room.expected(vista), 64, 2, false);
  }
}
TEST(sky_light, twin_a_sky_off_by_5_percent_is_caught) {
  SunThroughAHole room;
  Vista vista = room.vista(true);
  LightsFaults::scale_sky(vista.openings.selection, 1.05);
  for (const Integrator* integrator : {&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided})
    EXPECT_GT(rendered(vista, *integrator, 128, 16, 2).z(room.expected(vista)), 10)
        << integrator->name;
}

// Seen directly, the map is exact, and so is a sun beside it however small and bright.
TEST(sky_light, is_seen_as_it_is) {
  Outdoors out;
  out.box({0, -3, 0}, {0.5, 0.5, 0.5}, diffuse(0.5f));
  const Vec3d towards = normalize(Vec3d(0.3, 0.4, -1));
  Sky::Map map = uneven_map();
  for (Rgb& texel : map.texels) texel *= 1e6f;
  for (const double half_angle : {0.25 * kDegree, 1e-4}) {
    const auto sky = std::make_shared<Sky>(map, 0.3, std::vector{sun_of(towards, half_angle, 5)});
    for (const double yfov : {0.1, half_angle / 4}) {  // the second sees only the sun's disc
      out.look({0, 0, 0}, towards, yfov);
      const Vista vista = out.vista(sky, {rectangle({-1, -1, -1}, {0, 0, 2}, {2, 0, 0})});
      const Vec3d corner = vista.view.film.direction(0.5, 0.5);
      for (const Integrator* integrator : {&pt, &tdpt_guided}) {
        Job settings;
        settings.limits.spp = 64;
        const RenderResult r = render(vista, *integrator, settings);
        EXPECT_EQ(r.tally.not_finite, 0u);
        EXPECT_NEAR(luminance(r.picture.pixels[0]) / luminance(sky->radiance(corner)), 1, 0.01)
            << integrator->name;
      }
    }
  }
}

}  // namespace tdpt::sky_light_test
