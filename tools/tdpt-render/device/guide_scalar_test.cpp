// Guiding in floats against Guide in doubles, at random points of all kinds.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/guide.h"
#include "tools/tdpt-render/path/sample/walk.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/scalar_portals.h"

namespace tdpt::guide_scalar_test {

using shader::FROM_CAMERA;
using shader::FROM_LIGHT;
using shader::ScalarPortals;
using shader::vec3;

// A triangle and lamps of both kinds; the test adds portals.
Scene few_things() {
  Scene scene;
  scene.materials.resize(1);
  scene.materials[0].emission = Rgb(1.0f);
  scene.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}};
  scene.triangles.push_back({{0, 1, 2}, 0});
  scene.lights.resize(2);
  scene.lights[1].kind = PunctualLight::Kind::directional;
  scene.cameras.resize(1);
  return scene;
}

float number(Rng& rng) {
  return static_cast<float>(rng.bits() >> 40) * 0x1p-24f;
}
vec3 place(Rng& rng) {
  Vec3d p;
  for (int i = 0; i < 3; ++i) p[i] = 2 * rng.uniform() - 1;
  return vec3(p);
}
vec3 direction(Rng& rng) {
  return vec3(normalize(Vec3d(place(rng))));
}

// The same point in both.
struct Both {
  Vertex theirs;
  shader::Point mine{};
  Material material;
};

class Points {
 public:
  explicit Points(const Scene& scene) {
    lamps_.push_back(LightSource::punctual(scene.lights[0], 1));
    lamps_.push_back(LightSource::punctual(scene.lights[1], 1));
  }

  void draw(Rng& rng, Both& p) const {
    p.theirs = {};
    p.mine = {};
    p.mine.source = std::min(static_cast<uint32_t>(rng.uniform() * 10), 7u);
    if (p.mine.source == shader::SOURCE_SKY || p.mine.source > shader::SOURCE_LAMPS + 1)
      p.mine.source = shader::SOURCE_NONE;
    const bool surface = p.mine.source < shader::SOURCE_SKY;
    p.mine.position =
        surface || p.mine.source == shader::SOURCE_LAMPS ? place(rng) : direction(rng);
    p.mine.normal = surface ? direction(rng) : vec3();
    p.mine.triangle = surface ? 0 : shader::kNoTriangle;
    p.mine.simple = rng.uniform() < 0.5;
    p.mine.connectible = rng.uniform() < 0.9;
    p.material.base_color = p.mine.color = Rgb(number(rng));
    p.theirs.position = Vec3d(p.mine.position);
    p.theirs.normal = Vec3d(p.mine.normal);
    p.theirs.triangle = p.mine.triangle;
    p.theirs.simple = p.mine.simple;
    p.theirs.color = p.mine.color;
    p.theirs.connectible = p.mine.connectible;
    if (surface) p.theirs.material = &p.material;
    if (p.mine.source >= shader::SOURCE_LAMPS)
      p.theirs.source = &lamps_[p.mine.source - shader::SOURCE_LAMPS];
    else if (p.mine.source != shader::SOURCE_NONE)
      p.theirs.source = &surfaces_[p.mine.source == shader::SOURCE_BOTH];
    if (!p.mine.simple) add_lobes(rng, p);
  }

  /// Gives the scalar build a point that is not simple, as seen along `back`.
  static void look_at(const vec3& back, Both& p) {
    if (p.mine.simple) return;
    const Incidence in(p.theirs, Vec3d(back));
    const Odds odds = odds_at(p.theirs, in);
    const auto cos = static_cast<float>(std::abs(dot(p.mine.normal, back)));
    p.mine.bsdf.coat.strength = static_cast<float>(odds.dirac);
    p.mine.bsdf.coat.alpha = static_cast<float>(odds.broad) / cos;
    p.mine.bsdf.sheen_alpha = static_cast<float>(albedo_at(p.theirs, in)) - 0.1f * cos;
  }

 private:
  static void add_lobes(Rng& rng, Both& p) {
    Bsdf& b = p.theirs.bsdf;
    p.theirs.shading = p.theirs.normal;
    b = surfaces().diffuse_bsdf(Rgb(0.5f * number(rng)));
    b.f0 = Rgb(0.04f);
    b.f90 = 1;
    b.eta = 1.5f;
    b.thin = true;
    b.alpha = rng.uniform() < 0.3 ? 0 : number(rng);
    if (rng.uniform() < 0.3) b.through = Rgb(0.4f * number(rng));
    p.mine.bsdf.through = b.through;
  }

  std::array<LightSource, 2> surfaces_{LightSource::surface(false), LightSource::surface(true)};
  std::vector<LightSource> lamps_;
};

struct Off {
  int others = 0, directed = 0;  // of walks
};

struct Trial {
  const PortalTables tables;
  ScalarPortals scalar;
  const Guide guide;
  const Points points;
  Off off;

  Trial(const Vista& vista, const Mixture& mixture)
      : tables(vista.openings.portals),
        scalar(tables),
        guide(vista, mixture),
        points(vista.world->scene) {
    scalar.render = {static_cast<float>(mixture.guiding.chance[0]),
                     static_cast<float>(mixture.guiding.chance[1])};
    scalar.guide_active = guide.active();
    scalar.scene_has_portals = guide.sees_portals();
  }

  // A walk at some point continues with the same random numbers in both.
  void walk(Rng& rng) {
    Both at, to;
    points.draw(rng, at);
    points.draw(rng, to);
    const vec3 away = direction(rng);
    const bool begins = !at.theirs.on_surface() || (at.theirs.source && rng.uniform() < 0.5);
    const uint32_t from = begins || rng.uniform() < 0.5 ? FROM_LIGHT : FROM_CAMERA;
    const From way = from == FROM_LIGHT ? From::light : From::camera;
    const vec3 back = begins ? vec3() : away;
    if (!begins) Points::look_at(back, at);
    if (begins)
      guide.set_totals_at_light(at.theirs);
    else
      guide.set_totals_at_surface(Vec3d(away), at.theirs);
    const shader::GuideTotals guide_totals = begins ? scalar.guide_totals_at_light(at.mine)
                                                    : scalar.guide_totals_at_surface(at.mine, away);
    if (!guide.active()) {
      at.theirs.guide_totals = {};
      at.theirs.guide_totals.facing = Vec3d(guide_totals.facing);
    }
    if (!alike(at.theirs.guide_totals, guide_totals)) {
      ++off.others;
      return;
    }
    int triangle = -1;
    vec3 w, origin = at.mine.position;
    if (!same_draw(rng, at, guide_totals, back, from, begins, w, origin, triangle)) {
      ++off.others;
      return;
    }
    off.directed += triangle >= 0;
    go_to(rng, at, guide_totals, back, from, way, w, origin, triangle, to);
  }

  static bool alike(const GuideTotals& a, const shader::GuideTotals& b) {
    const auto close = [](double x, double y) { return std::abs(x - y) <= 1e-5 * x + 1e-9; };
    return length(a.facing - Vec3d(b.facing)) == 0 && close(a.from_light, b.from_light) &&
           close(a.from_camera, b.from_camera) &&
           std::abs(a.emitted - b.emitted) <= 1e-5 * a.emitted + 1e-4;
  }

  bool same_draw(Rng& rng, const Both& at, const shader::GuideTotals& guide_totals,
                 const vec3& back, uint32_t from, bool begins, vec3& w, vec3& origin,
                 int& triangle) const {
    const float u = number(rng), v = number(rng), pick = number(rng), whether = number(rng);
    int theirs = -1;
    Vec3d their_w, their_origin(at.mine.position);
    bool directed, mine;
    const std::array<double, 4> numbers{u, v, pick, whether};
    if (begins) {
      Lights::Ray ray{Vec3d(at.mine.position), Vec3d(at.mine.position)};
      directed = guide.active() && guide.leave(at.theirs, numbers, ray, theirs);
      their_w = ray.direction;
      their_origin = ray.origin;
      w = at.mine.position;
      mine = scalar.guide_leave(at.mine, guide_totals, u, v, pick, whether, origin, w, triangle);
    } else {
      const From way = from == FROM_LIGHT ? From::light : From::camera;
      const Incidence in(at.theirs, Vec3d(back));
      directed = guide.active() && guide.draw(at.theirs, &in, way, numbers, their_w, theirs);
      mine = scalar.guide_draw(at.mine, guide_totals, back, from, u, v, pick, whether, w, triangle);
    }
    if (!directed || !mine) return directed == mine;
    return theirs == triangle && length(their_w - Vec3d(w)) < 1e-5 &&
           length(their_origin - Vec3d(origin)) < 2e-6;
  }

  void go_to(Rng& rng, Both& at, const shader::GuideTotals& guide_totals, const vec3& back,
             uint32_t from, From way, vec3 w, vec3 origin, int triangle, Both& to) {
    if (triangle < 0) w = at.theirs.at_infinity() ? at.mine.position : direction(rng);
    if (!at.theirs.at_infinity()) origin = at.mine.position;
    if (to.theirs.at_infinity()) return;
    to.mine.position = origin + w * (0.1f + number(rng) + (at.theirs.at_infinity() ? 4.0f : 0.0f));
    to.theirs.position = Vec3d(to.mine.position);
    const Edge e = between(at.theirs, to.theirs);
    const shader::Edge my_e{vec3(e.w), static_cast<float>(e.d2)};
    uint64_t tests = 0;
    const PortalSet::Drawn drawn{triangle, -1};
    const shader::Drawn my_drawn = shader::drawn_through(triangle);
    const PortalSet::CrossingDensity c = from == FROM_LIGHT
                                             ? guide.crossing(at.theirs, to.theirs, tests, drawn)
                                             : guide.crossing(to.theirs, at.theirs, tests, drawn);
    const shader::CrossingDensity my_c = from == FROM_LIGHT
                                             ? scalar.edge_crossing(at.mine, to.mine, my_drawn)
                                             : scalar.edge_crossing(to.mine, at.mine, my_drawn);
    const Incidence in(at.theirs, Vec3d(back));
    const bool begins = back == vec3();
    const double p = guide.pdf_A(way, at.theirs, begins ? nullptr : &in, e, to.theirs, 0.25, c);
    const float per_area = shader::to_area(1.0f, my_e, to.mine);
    const double mine =
        scalar.guided_pdf_A(from, at.mine, guide_totals, back, 0.25f, per_area, my_c);
    const double apart = std::max(std::abs(mine / p - 1),
                                  std::abs(my_c.density - c.density) / std::max(c.density, 1e-3));
    off.others += apart > 1e-3;
  }
};

Off off_of(const PortalSet& set, const Mixture& mixture, const PortalSet* mine = nullptr) {
  const Scene scene = few_things();
  Vista vista(scene, scene.cameras[0], 16, 16, {});
  vista.openings.portals = set;
  Trial trial(vista, mixture);
  const PortalTables others(mine ? *mine : set);
  if (mine) trial.scalar = ScalarPortals(others);
  Rng rng(41, 0, 0);
  for (int i = 0; i < 100000; ++i) trial.walk(rng);
  return trial.off;
}

TEST(guide_scalar, walks_are_directed_as_in_doubles_and_have_the_densities) {
  for (const auto& [name, set] : portals_to_try()) {
    const Off off = off_of(set, tdpt_guided.mixture);
    EXPECT_GT(off.directed, 5000) << name;
    EXPECT_LT(off.others, 30) << name;  // borders, and edges that graze a plane
  }
}
TEST(guide_scalar, where_walks_are_not_directed_only_segments_are_known) {
  for (const auto& [name, set] : portals_to_try())
    for (const Integrator* integrator : {&tdpt_ref, &bdpt}) {
      const Off off = off_of(set, integrator->mixture);
      EXPECT_EQ(off.directed, 0) << name;
      EXPECT_LT(off.others, 100) << name;
    }
}
TEST(guide_scalar, twin_densities_2_percent_off) {
  for (const auto& [name, set] : portals_to_try()) {
    const PortalSet spoilt = PortalSetFaults::scaled(set, 1.02);
    EXPECT_GT(off_of(set, tdpt_guided.mixture, &spoilt).others, 1000) << name;
  }
}

}  // namespace tdpt::guide_scalar_test
