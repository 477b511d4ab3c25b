// The kernels' text in floats says what it says in doubles, or the renderer where it is written
// twice (texels, the sky's map), for the same random numbers. Each test compares one kind of thing
// in all vistas, and has its twin in itself: the same results, a hundredth off.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/scene/texture.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/bsdfs.h"
#include "tools/tdpt-render/testing/float_vistas.h"
#include "tools/tdpt-render/testing/surface_scene.h"

namespace tdpt {
namespace shader {

// weight.h in doubles, over the records that kernels have.
struct DoubleWeights {
  using Real = double;
  using Scaled = double;
  static double scaled(double x) { return x; }
  static double product(double a, double b) { return a * b; }
  static double quotient(double a, double b) { return a / b; }
  static double sum(double a, double b) { return a + b; }
  static double narrowed(double x) { return x; }
  const RenderParameters& render;
  const PathDensity* path_densities;
  bool power_heuristic;
  uint mixture_techniques;
  static constexpr bool scene_has_portals = true;
  LOADS(PathDensity, path_density, path_densities)
#include "shaders/shared/path/weight.h"
};

}  // namespace shader

namespace floats_test {

using shader::FROM_CAMERA;
using shader::FROM_LIGHT;
using shader::ScalarKernels;
using shader::vec3;

/// Counts results by whether they differ by more than they may.
class Results {
 public:
  /// Differs by more than `error` of the exact one; what is smaller than `least` counts as if it
  /// were so large.
  void hold(double floats, double doubles, double error, double least = 1e-6) {
    if (floats == 0 && doubles == 0) return;
    const double may = error * std::max(std::abs(doubles), least);
    count(std::abs(floats - doubles) <= may, std::abs(1.01 * floats - doubles) <= may);
  }
  void hold(const Vec3d& floats, const Vec3d& doubles, double error, double least = 1e-6) {
    if (floats == Vec3d() && doubles == Vec3d()) return;
    const double may = error * std::max(length(doubles), least);
    count(length(floats - doubles) <= may, length(floats * 1.01 - doubles) <= may);
  }
  void hold(const Vec3f& floats, const Vec3d& doubles, double error, double least = 1e-6) {
    hold(Vec3d(floats), doubles, error, least);
  }
  void hold(const Rgb& floats, const Rgb& doubles, double error, double least = 1e-6) {
    hold(Vec3d(floats), Vec3d(doubles), error, least);
  }
  /// Whether both decided alike.
  bool same(bool alike) {
    ++decisions_;
    others_ += !alike;
    return alike;
  }
  /// Decisions at borders, and results near them, may differ.
  void expect_off_at_most(double share, double others = 1e-3) const {
    const auto share_of = [](int n, int all) { return static_cast<double>(n) / std::max(all, 1); };
    EXPECT_GT(all_, 4000);
    EXPECT_LE(share_of(off_, all_), share);
    EXPECT_LE(share_of(others_, decisions_), others);
    EXPECT_GT(share_of(off_of_twin_, all_), 0.5 + share);
  }

 private:
  void count(bool held, bool twin_held) {
    ++all_;
    off_ += !held;
    off_of_twin_ += !twin_held;
  }
  int all_ = 0, off_ = 0, off_of_twin_ = 0, decisions_ = 0, others_ = 0;
};

vec3 place(Rng& rng, double size = 1) {
  Vec3d p;
  for (int i = 0; i < 3; ++i) p[i] = size * (2 * rng.uniform() - 1);
  return vec3(p);
}
vec3 direction(Rng& rng) {
  return vec3(test::uniform_direction(rng));
}

// Portals.

// A segment, and the crossings of an edge that is likely to cross the portal, or ends near it.
void compare_segment(const PortalSet& set, const ScalarKernels& floats, Rng& rng, Results& r) {
  std::array<float, 7> u;
  for (float& x : u) x = rng.uniform_float();
  const shader::SegmentDraw mine = floats.sample_segment(u[0], u[1], u[2], u[3], u[4], u[5], u[6]);
  const PortalSet::SegmentDraw exact = set.sample({u[0], u[1], u[2], u[3], u[4], u[5], u[6]});
  if (!r.same(mine.drawn.polygon == exact.drawn.polygon && mine.drawn.second == exact.drawn.second))
    return;
  r.hold(mine.position, exact.position, 5e-6, 1);
  r.hold(mine.direction, exact.direction, 5e-6);
  const vec3 aside = place(rng, 0.05);
  const auto t = [&] { return static_cast<float>(rng.uniform() * 1.2 - 0.2); };
  const vec3 a = mine.position + aside - mine.direction * t();
  const vec3 b = mine.position + aside + mine.direction * t();
  const shader::CrossingDensity c = floats.portal_crossing(a, b, shader::drawn_otherwise());
  const PortalSet::CrossingDensity d = set.portal_crossing(Vec3d(a), Vec3d(b), {});
  r.hold(c.density, d.density, 1e-4);
  r.hold(c.from_light, d.from_light, 1e-4);
  r.hold(c.from_camera, d.from_camera, 1e-4);
}

void compare_aim(const PortalSet& set, const ScalarKernels& floats, Rng& rng, Results& r) {
  const bool parallel = rng.uniform() < 0.3;
  const vec3 v = parallel ? direction(rng) : place(rng);
  const vec3 facing = parallel || rng.uniform() < 0.3 ? vec3(0.0f) : direction(rng);
  const uint32_t from = parallel || rng.uniform() < 0.5 ? FROM_LIGHT : FROM_CAMERA;
  const float u = rng.uniform_float(), w = rng.uniform_float(), pick = rng.uniform_float();
  const float mine = floats.portal_guide_total(parallel, v, facing, from);
  const double exact = set.portal_guide_total(parallel, Vec3d(v), Vec3d(facing), from);
  r.hold(mine, exact, 1e-4);
  if (!(mine > 1e-3f) || !(exact > 1e-3)) return;
  vec3 my_at;
  Vec3d at;
  if (!r.same(floats.draw_on_portal(parallel, v, facing, from, mine, u, w, pick, my_at) ==
              set.draw_on_portal(parallel, Vec3d(v), Vec3d(facing), from, exact, u, w, pick, at)))
    return;
  r.hold(my_at, at, 1e-5, 1);
}

TEST(floats, of_portals) {
  for (const auto& vista : vistas_with_portals()) {
    SCOPED_TRACE(vista->name);
    Rng rng(31, 0, 0);
    Results segments, aims;
    for (int i = 0; i < 20000; ++i) {
      compare_segment(vista->vista.openings.portals, vista->floats, rng, segments);
      compare_aim(vista->vista.openings.portals, vista->floats, rng, aims);
    }
    segments.expect_off_at_most(0.001);
    aims.expect_off_at_most(0.001);
  }
}

// Surfaces.

// Floats hold a direction to 2^-24, and a microfacet's slope as well. The density of slopes D
// changes by 4/alpha of itself per unit of slope, so it is accurate to some 1e-6/alpha; near total
// reflection transmission changes faster still.
double rounding(float alpha) {
  return 1e-5 + (alpha > 0 ? 5e-6 / alpha : 0);
}

// With its own shading normal, and a coat with another.
Point bent_point(const Bsdf& b, Rng& rng) {
  const auto tilted = [&rng](const Vec3d& n, double most) {
    return Vec3d(Vec3f(normalize(n + test::uniform_direction(rng) * (most * rng.uniform()))));
  };
  Point p = test::whole::point(b);
  p.normal = Vec3d(direction(rng));
  p.shading = tilted(p.normal, 0.5);
  p.bsdf.coat.normal = Vec3f(tilted({0, 0, 1}, 0.3));
  return p;
}
shader::Point in_floats(const Point& p) {
  shader::Point f{};
  f.position = Vec3f(p.position), f.normal = Vec3f(p.normal), f.shading = Vec3f(p.shading);
  f.simple = p.simple, f.connectible = p.connectible;
  f.bsdf = p.bsdf, f.color = p.color;
  return f;
}

void compare_bsdf(const ScalarKernels& floats, const Point& p, Rng& rng, Results& r) {
  const shader::Point q = in_floats(p);
  const vec3 back = direction(rng);
  // Skips directions whose side of a surface rounding may decide.
  const auto grazes = [&](const Vec3d& w) { return std::abs(dot(p.shading, w)) < 1e-3; };
  if (grazes(Vec3d(back))) return;
  const double error = 2 * rounding(p.bsdf.alpha);
  const Incidence in(p, Vec3d(back));
  r.hold(floats.albedo_at(q, back), albedo_at(p, in), 1e-5);
  const Odds odds = odds_at(p, in);
  const shader::Odds<float> my_odds = floats.odds_at(q, back);
  r.hold(my_odds.dirac, odds.dirac, 1e-5, 1);
  r.hold(my_odds.broad, odds.broad, 1e-5, 1);
  const uint32_t from = rng.uniform() < 0.5 ? FROM_LIGHT : FROM_CAMERA;
  const float u = rng.uniform_float(), v = rng.uniform_float(), choice = rng.uniform_float();
  shader::Turn<float> mine;
  Turn exact;
  const bool turns = floats.turn(q, from, back, u, v, choice, mine);
  if (!r.same(turns == turn(p, static_cast<From>(from), in, {u, v, choice}, exact)) || !turns)
    return;
  r.same(mine.dirac == exact.dirac);
  r.hold(mine.w, exact.w, 1e-3);
  vec3 to = mine.w;
  if (grazes(Vec3d(to))) return;
  Vec3d weight;
  const shader::Surfaces& s = surfaces();
  s.weigh(p, from, s.scatter_context_at(p, Vec3d(back)), s.seen_from(p, Vec3d(to)), mine.dirac,
          weight);
  r.hold(mine.weight, weight, p.bsdf.alpha > 0 ? 1e-4 + 2e-6 / p.bsdf.alpha : 1e-4);
  if (mine.dirac) to = direction(rng);
  if (grazes(Vec3d(to))) return;
  r.hold(floats.bsdf_at(q, to, back), bsdf_at(p, Vec3d(to), Vec3d(back)), error);
  r.hold(floats.scatter_pdf_w(q, back, to, false), scatter_pdf_w(p, in, Vec3d(to), false), error);
}

TEST(floats, of_bsdfs) {
  const FloatVista heap("heap", test::SurfaceHeap().scene());  // has all features
  for (const float alpha : {0.0f, 2e-4f, 2e-3f, 0.02f, 0.1f, 0.3f, 0.6f, 1.0f}) {
    SCOPED_TRACE(alpha);
    std::vector<test::NamedBsdf> kinds = test::white(alpha);
    for (const test::NamedBsdf& k : test::coloured(alpha)) kinds.push_back(k);
    kinds.push_back({"almost matched", test::glass(alpha, 1.01f)});
    kinds.push_back({"infinite index", test::glass(alpha, 1e6f)});
    Results r;
    Rng rng(32, 0, 0);
    for (const test::NamedBsdf& k : kinds)
      for (int i = 0; i < 200; ++i)
        compare_bsdf(heap.floats, i % 2 ? bent_point(k.b, rng) : test::whole::point(k.b), rng, r);
    r.expect_off_at_most(0.01);
  }
}

void compare_points(const shader::Point& a, const Point& b, double unit, double error, Results& r) {
  const auto hold = [&](const auto& mine, const auto& exact) { r.hold(mine, exact, error, 0.1); };
  hold(a.position, b.position);
  hold(a.normal, b.normal);
  hold(a.emission * static_cast<float>(unit), b.emission);
  r.same(a.simple == bool(b.simple) && a.connectible == b.connectible);
  r.same((a.source == shader::SOURCE_NONE) == !b.source &&
         (a.source == shader::SOURCE_BOTH) == (b.source && b.material->double_sided));
  if (b.simple) return hold(a.color, b.color);
  hold(a.shading, b.shading);
  const Bsdf &f = a.bsdf, &g = b.bsdf;
  for (const auto& [mine, exact] : {std::pair(f.diffuse, g.diffuse),
                                    {f.f0, g.f0},
                                    {f.dip, g.dip},
                                    {f.through, g.through},
                                    {f.sheen, g.sheen}})
    hold(Rgb(mine), Rgb(exact));
  for (const auto& [mine, exact] : {std::pair(f.f90, g.f90),
                                    {f.alpha, g.alpha},
                                    {f.eta, g.eta},
                                    {f.coat.strength, g.coat.strength}})
    hold(mine, exact);
  r.same(f.thin == g.thin);
  if (max_component(Rgb(g.sheen)) > 0) hold(f.sheen_alpha, g.sheen_alpha);
  if (!(g.coat.strength > 0)) return;
  hold(f.coat.alpha, g.coat.alpha);
  hold(f.coat.normal, Vec3d(g.coat.normal));
  if (max_component(Rgb(g.diffuse)) > 0) hold(Rgb(f.coat.under), Rgb(g.coat.under));
}

void compare_surface(const FloatVista& vista, uint32_t triangle, double error, Rng& rng,
                     Results& r) {
  const float b1 = rng.uniform_float(), b2 = rng.uniform_float() * (1 - b1);
  shader::Point mine;
  vista.floats.place_on_surface(triangle, b1, b2, mine);
  Hit hit;
  const TriangleShape s = shape_of(vista.scene, triangle);
  hit.triangle = triangle, hit.b1 = b1, hit.b2 = b2;
  hit.position = s.p0 + s.e1 * hit.b1 + s.e2 * hit.b2, hit.normal = s.normal;
  Point exact;
  place_on_surface(*vista.vista.world, hit, exact);
  compare_points(mine, exact, vista.tables.radiance_unit, error, r);
  r.hold(vista.floats.coverage_at(triangle, b1, b2), coverage_at(vista.scene, {triangle, b1, b2}),
         error, 0.1);
  const vec3 w = direction(rng);
  const Pane pane = pane_of(*exact.material);
  r.hold(vista.floats.opacity_at(triangle, w * 1e-3f),
         pane ? pane.opacity(dot(s.normal, Vec3d(w))) : 1, error);
  r.hold(vista.floats.transmittance(mine, mine, w, 0.7f),
         transmittance(exact, exact, Vec3d(w), 0.7), error);
}

// Two things may differ: a texel without interpolation, at its edge, and what flips with a normal.
TEST(floats, of_surfaces) {
  for (const double reach : {3, 300}) {  // of texture coordinates
    const FloatVista heap("heap", test::SurfaceHeap(reach).scene());
    Results r;
    Rng rng(33, 0, 0);
    for (uint32_t i = 0; i < 20 * test::SurfaceHeap::kTriangles; ++i)
      compare_surface(heap, i % test::SurfaceHeap::kTriangles, reach < 10 ? 1e-4 : 9e-3, rng, r);
    r.expect_off_at_most(0.001);
  }
}

// Lights.

// Index of the renderer's light: its kind, and which of the lamps.
uint32_t source_of(const Lights& lights, const LightSource* source) {
  if (!source) return shader::SOURCE_NONE;
  if (source->is_sky()) return shader::SOURCE_SKY;
  if (source->is_surface())
    return source->both_sides() ? shader::SOURCE_BOTH : shader::SOURCE_FRONT;
  return shader::SOURCE_LAMPS + static_cast<uint32_t>(source - lights.lamps().data());
}

// Where a walk begins, and along which ray. Places in the sky are drawn by other tables
// [word_tables_test.cpp].
void compare_start(const FloatVista& vista, uint64_t i, Results& r) {
  const Lights& lights = vista.vista.world->lights;
  const LightSelection& selection = vista.vista.openings.selection;
  const ScalarKernels& floats = vista.floats;
  const FourNumbers n(72, i), m(73, i);
  shader::LightPlace p = floats.sample_light(n.pick, n.u, n.v, n.side);
  Lights::Point q = selection.sample(n.pick, n.u, n.v, n.side);
  if (!r.same(p.source == source_of(lights, q.source) &&
              (q.source->is_sky() || p.triangle == q.triangle)))
    return;
  if (q.source->is_sky()) {
    q.position = normalize(Vec3d(p.position));
    q.in_sky = selection.look(-q.position);
    q.pdf = selection.pdf(*q.source, q.triangle, q.position, q.in_sky);
  }
  r.hold(p.position, q.position, 1e-6, 1);
  r.hold(p.normal, q.normal, 1e-6);
  r.hold(p.pdf, q.pdf, q.source->is_sky() ? 5e-3 : 1e-6);
  r.hold(p.b1, q.b1, 1e-6, 1);
  r.hold(p.b2, q.b2, 1e-6, 1);
  vec3 origin, w;
  floats.leave_light(p, m.u, m.v, origin, w);
  const Lights::Ray ray = lights.leave(q, m.u, m.v);
  r.hold(origin, ray.origin, 2e-6, 1);
  r.hold(w, ray.direction, 1e-6);
  const LightSource& source = *q.source;
  r.same(floats.source_met(p.source) == source.met() &&
         floats.source_at_infinity(p.source) == source.at_infinity() &&
         Vec3d(floats.source_facing(p.source, p.normal)) == source.facing(Vec3d(p.normal)));
  r.hold(floats.cos_per_pdf_w(p.source, w), source.cos_per_pdf_w(ray.direction), 1e-5);
  r.hold(floats.emission_pdf_w(p.source, p.normal, w), source.pdf_w(q.normal, ray.direction), 1e-4);
  const double unit = source.is_surface() ? 1 : vista.tables.radiance_unit;
  r.hold(floats.source_radiance(p.source, p.normal, Rgb(1, 2, 3), p.in_sky, w) *
             static_cast<float>(unit),
         source.emitted(q.normal, Rgb(1, 2, 3), ray.direction), 1e-4);
}

// In any direction, or in one where most of the light is.
void compare_sky(const FloatVista& vista, uint64_t i, Results& r) {
  const FourNumbers n(75, i);
  Rng rng(34, 0, i);
  const vec3 w = i % 2 ? direction(rng)
                       : vista.floats
                             .drawn_in_sky(vista.tables.lights.settings.plain,
                                           vista.floats.pick_word(n.pick, n.side), n.u, n.v)
                             .towards;
  const shader::InSky mine = vista.floats.look_at_sky(w);
  const Lights::InSky exact = vista.vista.openings.selection.look(normalize(Vec3d(w)));
  r.hold(mine.radiance * static_cast<float>(vista.tables.radiance_unit), exact.radiance, 1e-3,
         1e-3);
  // Below 1/65535 of a block's light entries are rounded.
  r.hold(mine.plain_w, exact.plain_w, 5e-3, 1e-3);
}

TEST(floats, of_lights) {
  for (const auto& vista : lit_vistas()) {
    SCOPED_TRACE(vista->name);
    Results starts, sky;
    for (uint64_t i = 0; i < 5000; ++i) {
      compare_start(*vista, i, starts);
      if (vista->tables.lights.has_sky) compare_sky(*vista, i, sky);
    }
    starts.expect_off_at_most(0.001);
    if (vista->tables.lights.has_sky) sky.expect_off_at_most(0.001);
  }
}

// A next event at a place in the rooms, behind windows and before rectangular lights, which
// transmits light or not.
void compare_next_event(const FloatVista& vista, uint64_t i, Rng& rng, Results& r) {
  const NextEvents next_events = vista.vista.next_events();
  const ScalarKernels& floats = vista.floats;
  constexpr float kThrough = 0.5f;
  const double x = 4.2 * rng.uniform() - 0.05, y = 2.1 * rng.uniform() - 0.05;
  Vertex v;
  v.position = Vec3d(Vec3f(vista.scene.frame.to_canonical({x, y, 2.1 * rng.uniform() - 1.05})));
  v.normal = v.shading = Vec3d(direction(rng));
  v.material = &vista.scene.materials[0];
  v.simple = rng.uniform() < 0.7;
  if (!v.simple) v.bsdf.through = Rgb(0.5f);
  next_events.look_out(v.normal, v);
  next_events.look_at_rect_lights(v);
  shader::Point p = in_floats(v);
  p.triangle = 0;
  p.connectible = true;
  shader::LightContext context{};
  floats.look_out(p, v.simple ? p.normal : vec3(0.0f), context);
  if (vista.tables.lights.has_rect_lights) r.hold(context.sent, v.light_context.sent, 1e-3, 1e-3);
  if (vista.tables.lights.has_windows) {
    if (!r.same((context.seen > 0) == (v.light_context.seen > 0))) return;
    r.hold(context.seen * vista.tables.radiance_unit, v.light_context.seen, 2e-3, 1e-3);
  }
  const FourNumbers n(74, i);
  Lights::Point at = next_events.sample(v, kThrough, n.pick, n.u, n.v, n.side);
  const shader::LightPlace mine =
      floats.sample_next_event(p, context, kThrough, n.pick, n.u, n.v, n.side);
  if (!r.same(mine.source == source_of(vista.vista.world->lights, at.source)) || !at.source) return;
  if (at.source->is_sky()) {  // drawn by other tables
    if (!(mine.pdf > 0)) return;
    at.position = normalize(Vec3d(mine.position));
    at.in_sky = vista.vista.openings.selection.look(-at.position);
  } else {
    r.same(mine.triangle == at.triangle);
    r.hold(mine.position, at.position, 1e-4, 1);
  }
  Point light;
  light.source = at.source, light.triangle = at.triangle, light.position = at.position;
  light.in_sky = at.in_sky;
  r.hold(mine.pdf, next_events.pdf(v, light).of(kThrough), 5e-3);
  r.hold(floats.next_event_pdf(p, context, kThrough, mine.source, at.triangle, Vec3f(at.position),
                               mine.in_sky),
         next_events.pdf(v, light).of(kThrough), 5e-3);
  if (!(context.seen > 0) || !(v.light_context.seen > 0)) return;
  r.hold(floats.towards_window(p.position, context.facing, context.seen, n.pick, n.u, n.v),
         vista.vista.openings.windows.towards_window(v.position, v.light_context.facing,
                                                     v.light_context.seen, n.pick, n.u, n.v),
         1e-3);
}

TEST(floats, of_next_events) {
  for (const auto& vista : lit_vistas()) {
    SCOPED_TRACE(vista->name);
    Results r;
    Rng rng(35, 0, 0);
    for (uint64_t i = 0; i < 5000; ++i) compare_next_event(*vista, i, rng, r);
    r.expect_off_at_most(0.001);
  }
}

// MIS weights.

// Records of k vertices with densities over many decades, as one half of a path or two.
std::vector<shader::PathDensity> random_records(Rng& rng, uint32_t k, uint32_t s) {
  const auto density = [&] {
    return static_cast<float>(std::pow(10.0, 12 * (rng.uniform() - 0.5)));
  };
  std::vector<shader::PathDensity> records(k);
  for (uint32_t i = 0; i < k; ++i) {
    shader::PathDensity& d = records[i];
    d.own_A = density();
    d.other_A = density();
    d.pair_A = rng.uniform() < 0.5 ? density() : 0;
    d.nee_A = density();
    d.other_survival = static_cast<float>(0.1 + 0.9 * rng.uniform());
    // x_{s-1} to x_0, then x_s to x_{k-1}, each at its own index.
    d.prev = i < s ? i - 1 : i + 1 < k ? i + 1 : shader::kNoVertex;
    d.flags = shader::VERTEX_THERE | (rng.uniform() < 0.2 ? shader::VERTEX_DIRAC : 0u);
  }
  if (s > 0) records[0].prev = shader::kNoVertex;
  return records;
}

TEST(floats, of_weights_whose_densities_leave_the_range_of_floats) {
  ScalarKernels floats{};
  floats.scene_has_portals = true;
  floats.mixture_techniques = floats.render.techniques = 31;
  floats.render.first_direct = 6, floats.render.later_direct = 2;
  floats.render.light_walks = 0.25f, floats.render.connected = 1.7f;
  floats.render.connected_to_segments = 1.3f;
  floats.render.segments = 0.5f, floats.render.segments_connected = 16;
  Results r;
  Rng rng(36, 0, 0);
  for (int n = 0; n < 20000; ++n) {
    floats.power_heuristic = n % 2 == 1;
    const uint32_t k = 3 + rng.below(7), s = rng.below(k - 1);
    std::vector<shader::PathDensity> records = random_records(rng, k, s);
    floats.path_densities = records.data();
    const shader::DoubleWeights doubles{floats.render, records.data(), floats.power_heuristic,
                                        floats.mixture_techniques};
    std::array<float, 8> x;
    for (float& density : x) density = static_cast<float>(std::pow(10.0, 6 * rng.uniform() - 3));
    // Of a connection, a next event and a segment whose vertices are x_s and x_{s+1}.
    const auto weigh = [&](const auto& of, auto real) {
      using Real = decltype(real);
      const auto half = [&](uint32_t slot, bool there, size_t first) {
        return there ? shader::Half<Real>{slot, x[first], x[first + 1]}
                     : shader::Half<Real>{shader::kNoVertex, 0, 0};
      };
      const shader::Half<Real> light = half(s - 1, s > 0, 0);
      const shader::SegmentDensities<Real> segment{x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]};
      std::vector<double> weights;
      if (s != 1)
        weights.push_back(
            of.share_of(of.weight_of_split(s, k),
                        of.strategies_of_connected(light, half(s, true, 2), s, k, x[4])));
      if (s == 0)
        weights.push_back(
            of.share_of(of.weight_of_direct(k),
                        of.strategies_of_next_event(half(1, true, 2), k, x[4], x[5], x[6], x[7])));
      weights.push_back(
          of.share_of(of.weight_of_portal(s, k),
                      of.strategies_of_segment(light, half(s + 2, s + 2 < k, 2), s, k, segment)));
      return weights;
    };
    const std::vector<double> mine = weigh(floats, float{}), exact = weigh(doubles, double{});
    for (size_t i = 0; i < mine.size(); ++i) r.hold(mine[i], exact[i], 1e-4, 1e-20);
  }
  r.expect_off_at_most(0.001);
}

}  // namespace floats_test
}  // namespace tdpt
