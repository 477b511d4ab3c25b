// Guided walks follow their density, by chi-square over bins of the sphere, and choose smooth lobes
// as often as without portals, by the binomial distribution. No density integrates to more than 1.
//
// The walks are those of walk.h, in a box with one piece of the material under test, or one lamp,
// in its middle: each hits it at the same point, and the direction of its next edge is tested.
#include <gtest/gtest.h>

#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/walk.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt::guide_test {

constexpr double kLevel = 1e-3;  // a right program fails a whole TEST with this probability
constexpr double kWrong = 1e-9;  // a wrong one stays below
constexpr uint64_t kSamples = 30000;
const Guiding kGuiding = tdpt_guided.mixture.guiding;
// Normal of the piece in the middle, tilted against everything else.
const Vec3d kUp = normalize(Vec3d(0.1, 0.2, 1));

// Rectangle about `centre` with half sides u and v; light crosses it along cross(u, v).
Portal plate(const Vec3d& centre, const Vec3d& u, const Vec3d& v) {
  return rectangle(centre - u - v, u * 2, v * 2);
}
Portal turned_round(Portal portal) {
  for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  return portal;
}
std::vector<Portal> turned_round(std::vector<Portal> portals) {
  for (Portal& p : portals) p = turned_round(p);
  return portals;
}
std::vector<Portal> operator+(std::vector<Portal> a, const std::vector<Portal>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Portals for walks from the camera that stand in the middle; turned around for those from the
// light.
const std::vector<Portal> kOne{plate({0.2, 0.1, 0.5}, {0, 0.25, 0}, {0.2, 0, 0.05})};
const std::vector<Portal> kAside{plate({-0.5, 0, 0.4}, {0, 0.1, 0}, {0, 0, 0.2}),
                                 plate({-0.1, 0.6, 0.3}, {0.15, 0, 0}, {0, 0, 0.1})};
const std::vector<Portal> kInSeries =
    kOne + std::vector{plate({0.3, 0.1, 0.8}, {0, 0.2, 0}, {0.3, 0, 0})};
const std::vector<Portal> kHalfBelow{plate({0.5, 0, 0}, {0, 0, 0.3}, {0, 0.3, 0})};
const std::vector<Portal> kBelow{plate({0.2, 0, -0.5}, {0.25, 0, 0}, {0, 0.25, 0})};
const std::vector<Portal> kWrongSide = turned_round(kOne);
// Its plane is 0.01 away.
const std::vector<Portal> kGrazing{plate({0.4, 0.01, 0.4}, {0.2, 0, 0}, {0, 0, 0.2})};

enum class Kind { diffuse, rough, glossy, plastic, sheet };
Material material(Kind kind) {
  Material m;
  m.base_color = {0.8f, 0.5f, 0.3f};
  m.plain = kind == Kind::diffuse;
  if (m.plain) return m;
  m.specular = 1;
  m.metallic = kind == Kind::rough ? 0.5f : 0;
  m.roughness = 0.6f;
  if (kind == Kind::glossy) m.roughness = 0.4f;  // a narrow lobe over a diffuse base
  if (kind == Kind::plastic) m.roughness = 0;
  if (kind == Kind::sheet) m.transmission = 0.6f, m.double_sided = true;
  return m;
}

// Probability that a walk which came from `back` chooses a smooth lobe.
double smooth_share(const Vertex& at, const Vec3d& back) {
  return at.simple ? 0 : odds_at(at, Incidence(at, back)).dirac;
}

void add_triangle(Scene& scene, const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t material) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const Vec3d& p : {a, b, c}) scene.positions.push_back(Vec3f(p));
  scene.triangles.push_back({{first, first + 1, first + 2}, material});
}

// The box [-1,1]^3 with dull walls, and a triangle of about that size in its middle.
Scene box(const Material& middle, double size) {
  Scene scene;
  scene.materials = {Material{}, middle};
  const Vec3d axes[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  for (size_t i = 0; i < 3; ++i)
    for (const Vec3d& to : {Vec3d(), axes[i]})
      scene = with_sheet(scene, Material(), Vec3d(-1, -1, -1) + to, axes[(i + 1) % 3],
                         axes[(i + 2) % 3]);
  const Onb<double> onb(kUp);
  const double far = size * std::sqrt(0.75);
  add_triangle(scene, onb.x * size, onb.x * (-0.5 * size) + onb.y * far,
               onb.x * (-0.5 * size) - onb.y * far, 1);
  // Between the middle and some of the portals: walks end on it in front of them.
  add_triangle(scene, {0.1, 0, 0.35}, {0.25, 0.05, 0.35}, {0.1, 0.1, 0.35}, 0);
  Camera camera;
  camera.position = {-0.3, 0.2, 0.4};
  camera.forward = normalize(-camera.position);
  camera.right = normalize(cross(camera.forward, Vec3d(0, 0, 1)));
  camera.up = cross(camera.right, camera.forward);
  scene.cameras.push_back(camera);
  return scene;
}

// Where a walk stands whose next direction is tested.
struct Stand {
  const Vista& vista;
  Guide guide;
  From from;
  Vertex before, at;
  Vec3d back{};  // 0: the walk begins there

  Stand(const Vista& w, From f) : vista(w), guide(w, tdpt_guided.mixture), from(f) {}

  // Density [1/sr] of continuing along w by a lobe that is not Dirac. `least`: lower limit of the
  // surface's own density, for a twin.
  double pdf_w(const Vec3d& w, double least = 0) const {
    Hit hit;
    if (!vista.world->tracer.closest(at.origin(), w, hit)) return 0;
    Vertex to;
    place_on_surface(*vista.world, hit, to);
    const Edge e = between(at, to);
    const double plain = std::max(
        back == Vec3d() ? emission_pdf_A(at, e, to)
                        : scatter_pdf_A(at, Incidence(at, between(at, before).w), e, to, false),
        least);
    uint64_t tests = 0;
    const PortalSet::CrossingDensity c =
        from == From::light ? guide.crossing(at, to, tests) : guide.crossing(to, at, tests);
    const Incidence in(at, back);
    const Incidence* const from_where = back == Vec3d() ? nullptr : &in;
    return guide.pdf_A(from, at, from_where, e, to, plain, c) * e.d2 / to.cosine(e.w);
  }
  double& aim() {  // W
    if (back == Vec3d()) return at.guide_totals.emitted;
    return from == From::light ? at.guide_totals.from_light : at.guide_totals.from_camera;
  }
  double aim() const { return Stand(*this).aim(); }
};

struct Case {
  std::string name;
  From from;
  Scene scene;
  std::vector<Portal> portals;
  bool begins = false;  // at a lamp in the middle
  bool bent = false;    // reflects into the surface: a walk that chooses the smooth lobe ends
  // Tilted: seen from the middle no portal's border runs along one of a bin, where quadrature would
  // miss what lies beyond it.
  SphereBins bins{normalize(Vec3d(0.31, -0.52, 0.83)), 2, 8, 12};

  Vista vista() const { return Vista(scene, scene.cameras[0], 64, 64, portals); }
};

// A walk that scatters at a piece of `kind` in the middle.
Case scatters(const std::string& name, From from, Kind kind, const std::vector<Portal>& portals) {
  Case c{name, from, box(material(kind), 0.05),
         from == From::light ? turned_round(portals) : portals};
  if (from == From::light) {
    // A narrow cone of light from where the camera is.
    PunctualLight spot;
    spot.kind = PunctualLight::Kind::spot;
    spot.position = c.scene.cameras[0].position;
    spot.direction = normalize(-spot.position);
    spot.cos_inner = 1;
    spot.cos_outer = 1 - 1e-13;
    spot.intensity = Rgb(1.0f);
    c.scene.lights.push_back(spot);
  }
  return c;
}

// Its normal is tilted so far that what is mirrored lies in the surface.
Case bent(Case c) {
  const uint32_t middle = 12;
  c.scene.smooth.assign(c.scene.triangles.size(), 0);
  c.scene.smooth[middle] = 1;
  c.scene.normals.resize(c.scene.positions.size());
  const Vec3d back = normalize(c.scene.cameras[0].position);
  const Vec3d away = normalize(kUp * dot(kUp, back) - back);
  for (const uint32_t v : c.scene.triangles[middle].vertex)
    c.scene.normals[v] = Vec3f(normalize(kUp + away * 0.73));
  c.scene.materials[1].specular_color = Rgb(12);
  c.bent = true;
  return c;
}

// A walk that begins at a lamp in the middle.
Case begins(const std::string& name, Material lamp, const std::vector<Portal>& portals) {
  lamp.emission = Rgb(1.0f);
  return {name, From::light, box(lamp, 1e-5), turned_round(portals), true};
}
Case begins_at_a_point(const std::string& name, const std::vector<Portal>& portals) {
  Case c{name, From::light, box(Material{}, 1e-5), turned_round(portals), true};
  PunctualLight lamp;
  lamp.position = kUp * 0.02;
  lamp.intensity = Rgb(1.0f);
  c.scene.lights.push_back(lamp);
  return c;
}

Stand stand_of(const Vista& vista, const Case& c) {
  Stand s(vista, c.from);
  if (c.from == From::light) {
    place_on_light(*vista.world, vista.openings.selection.sample(0.5, 1.0 / 3, 0.5, 0),
                   c.begins ? s.at : s.before);
    if (c.begins) {
      s.guide.set_totals_at_light(s.at);
      return s;
    }
  } else {
    s.before = {};
    s.before.position = vista.view.film.position();
  }
  Hit hit;
  const Vec3d w =
      c.from == From::light ? -normalize(s.before.position) : vista.view.film.direction(32, 32);
  EXPECT_TRUE(vista.world->tracer.closest(s.before.origin(), w, hit));
  place_on_surface(*vista.world, hit, s.at);
  EXPECT_LT(length(s.at.position), 1e-6);
  s.guide.set_totals_at_surface(-w, s.at);
  s.back = -w;
  return s;
}

struct Judgement {
  double p = 1, dirac_p = 1;
  double total = 0;  // of the density and the Dirac lobes
};

template <class Pdf>
Judgement judge(const Case& c, const Stand& s, uint64_t stream, const Pdf& pdf_w) {
  const int begin = c.begins ? 0 : 1;  // the vertex under test
  Walk walk;
  RayCounts rays;
  uint64_t tried = 0, dirac = 0;
  const std::vector<double> share = c.bins.integrate(pdf_w);
  const ChiSquare chi = chi_square_of_samples(kSamples, share, [&](uint64_t) {
    do {  // until it reaches the vertex under test: walks from lamps are guided, too
      const Sequence numbers(7, stream, tried++, 0);
      if (c.from == From::camera)
        walk_from_camera(s.vista, s.guide, s.vista.view.film, 32, 32, begin + 1, numbers, walk,
                         rays);
      else
        walk_from_light(s.vista, s.guide, begin + 1, numbers, walk, rays);
    } while (walk.size <= begin ||
             (!c.begins && length(walk[begin].position - s.at.position) > 1e-3));
    if (walk.size == begin + 1) return c.bins.size();
    if (!walk.state(begin).dirac) return c.bins.bin(between(walk[begin], walk[begin + 1]).w);
    ++dirac;
    return c.bins.size();
  });
  const double smooth = c.begins || c.bent ? 0 : smooth_share(s.at, s.back);
  Judgement j{chi.p, binomial_p(dirac, kSamples, smooth), smooth};
  for (double x : share) j.total += x;
  return j;
}

// Every density integrates to at most 1 and is followed.
void all_hold(const std::vector<Case>& cases) {
  const double least = sidak(kLevel, 2 * cases.size());
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const Vista vista = c.vista();
    const Stand s = stand_of(vista, c);
    EXPECT_GT(s.aim(), 0) << c.name;
    const Judgement j = judge(c, s, i, [&](const Vec3d& w) { return s.pdf_w(w); });
    EXPECT_GT(j.p, least) << c.name;
    EXPECT_GT(j.dirac_p, least) << c.name;
    EXPECT_LT(j.total, 1 + 1e-3) << c.name;
    EXPECT_GT(j.total, 0.2) << c.name;
  }
}

TEST(guide, surfaces_send_walks_at_portals_as_their_density_says_and_keep_their_smooth_lobes) {
  constexpr From kLight = From::light, kCamera = From::camera;
  std::vector<Case> cases{
      scatters("one", kCamera, Kind::diffuse, kOne),
      scatters("several", kLight, Kind::diffuse, kOne + kAside),
      scatters("in series", kCamera, Kind::diffuse, kInSeries),
      scatters("half below", kLight, Kind::diffuse, kHalfBelow),
      // The one below comes first, so that a wrong choice would take it.
      scatters("one above, one below", kCamera, Kind::diffuse, kBelow + kOne),
      scatters("one of them looks away", kLight, Kind::diffuse, kAside + kWrongSide),
      scatters("grazing", kCamera, Kind::diffuse, kGrazing),
      scatters("rough", kLight, Kind::rough, kOne + kAside),
      scatters("rough, half below", kCamera, Kind::rough, kHalfBelow),
      scatters("glossy", kLight, Kind::glossy, kOne + kAside),
      scatters("glossy, in series", kCamera, Kind::glossy, kInSeries),
      scatters("smooth plastic", kLight, Kind::plastic, kOne + kAside),
      scatters("smooth plastic, half below", kCamera, Kind::plastic, kHalfBelow),
      bent(scatters("smooth plastic, bent", kCamera, Kind::plastic, kOne + kAside)),
      scatters("sheet, above and below", kCamera, Kind::sheet, kBelow + kOne),
      scatters("sheet, half below", kLight, Kind::sheet, kHalfBelow)};
  // A narrow strip as seen from the middle, which crosses bins and does not run along them.
  cases[6].bins = SphereBins(normalize(Vec3d(0.4, 0.07, 0.37)), 0.2, 12, 48);
  all_hold(cases);
}

TEST(guide, lamps_do_so_too) {
  Material black, mirror, both;
  black.base_color = Rgb(0.0f);
  mirror.plain = false;
  mirror.metallic = 1;
  mirror.roughness = 0;
  both.double_sided = true;
  all_hold({begins("one-sided", Material{}, kOne + kAside),
            begins("one-sided, half below", Material{}, kHalfBelow),
            begins("one-sided, above and below", Material{}, kBelow + kOne),
            begins("black, in series", black, kInSeries), begins("mirror", mirror, kOne + kAside),
            begins("double-sided, half below", both, kHalfBelow),
            begins("double-sided, above and below", both, kBelow + kOne),
            begins_at_a_point("point", kBelow + kOne + kAside),
            begins_at_a_point("point, in series", kInSeries)});
}

TEST(guide, what_cannot_be_reached_is_never_aimed_at) {
  std::vector<Case> cases{begins("lamp, below", Material{}, kBelow),
                          begins("lamp, wrong side", Material{}, kWrongSide),
                          begins_at_a_point("point, wrong side", kWrongSide)};
  for (const From from : {From::light, From::camera})
    for (const Kind kind : {Kind::diffuse, Kind::rough, Kind::plastic}) {
      cases.push_back(scatters("below", from, kind, kBelow));
      cases.push_back(scatters("below, looking away", from, kind, turned_round(kBelow)));
      cases.push_back(scatters("wrong side", from, kind, kWrongSide));
      // In its very plane.
      cases.push_back(
          scatters("edge on", from, kind, {plate({0.4, 0, 0.4}, {0.2, 0, 0}, {0, 0, 0.2})}));
    }
  for (const Case& c : cases) {
    const Vista vista = c.vista();
    EXPECT_EQ(stand_of(vista, c).aim(), 0) << c.name;
  }
}

// Twins: `spoil` gets the stand and W, and changes what the density is computed from.
template <class Spoil>
Judgement spoilt(const Case& c, Spoil spoil, double least = 0) {
  const Vista vista = c.vista();
  Stand s = stand_of(vista, c);
  EXPECT_GT(s.aim(), 0) << c.name;
  // Walks use a stand of their own.
  spoil(s, s.aim());
  return judge(c, s, 1, [&](const Vec3d& w) { return s.pdf_w(w, least); });
}
// Dark, so that walks are guided as often as possible.
std::vector<Case> each_kind(const std::vector<Portal>& portals) {
  std::vector<Case> cases{scatters("diffuse", From::camera, Kind::diffuse, portals),
                          scatters("rough", From::light, Kind::rough, portals),
                          scatters("glossy", From::camera, Kind::glossy, portals),
                          scatters("plastic", From::camera, Kind::plastic, portals),
                          scatters("sheet", From::light, Kind::sheet, portals),
                          begins("lamp", Material{}, portals),
                          begins_at_a_point("point", portals)};
  for (Case& c : cases) c.scene.materials[1].base_color = Rgb(0.3f);
  return cases;
}

// The oracle of path_test knows of 5 %, path by path.
TEST(guide, twin_densities_of_aiming_a_fifth_off) {
  for (const Case& c : each_kind(kOne + kAside)) {
    const Judgement j = spoilt(c, [&](Stand& s, double) { s.aim() *= 0.8; });
    EXPECT_LT(j.p, kWrong) << c.name;
    if (c.name == "diffuse") {
      EXPECT_GT(j.total, 1 + 1e-3);
    }
  }
}
TEST(guide, twin_weights_of_facets_that_do_not_add_up_to_1) {
  for (const Case& c : {scatters("diffuse", From::camera, Kind::diffuse, kOne + kAside),
                        begins("lamp", Material{}, kOne + kAside)})
    EXPECT_LT(spoilt(c, [](Stand& s, double W) { s.aim() /= W; }).p, kWrong) << c.name;
}
// W includes portals below the horizon: less is left for the others.
TEST(guide, twin_a_density_that_knows_no_horizon_when_it_chooses) {
  for (const From from : {From::light, From::camera}) {
    const Case c = scatters("above and below", from, Kind::diffuse, kBelow + kOne);
    const Judgement j = spoilt(c, [&](Stand& s, double W) {
      const double all = s.vista.openings.portals.portal_guide_total(false, s.at.position, Vec3d(),
                                                                     static_cast<uint32_t>(from));
      EXPECT_GT(all, 1.2 * W);
      s.aim() *= all / W;
    });
    EXPECT_LT(j.p, kWrong);
  }
}
// What is aimed below the horizon is not scattered there.
TEST(guide, twin_a_density_that_knows_no_horizon_when_it_scatters) {
  for (const Case& c : {scatters("scatters", From::camera, Kind::diffuse, kHalfBelow),
                        begins("begins", Material{}, kHalfBelow)})
    EXPECT_LT(spoilt(
                  c, [](Stand&, double) {}, 1e-30)
                  .p,
              kWrong)
        << c.name;
}
TEST(guide, twin_smooth_lobes_that_are_directed_too) {
  Case c = scatters("smooth", From::camera, Kind::plastic, kOne);
  c.scene.materials[1].base_color = Rgb(0.3f);  // guided often
  double smooth = 0;
  const Judgement j = spoilt(c, [&](Stand& s, double) {
    smooth = smooth_share(s.at, s.back);
    s.aim() *= 1 - smooth;
  });
  EXPECT_LT(j.p, kWrong);
  // And their share, if walks were guided instead of taking a smooth lobe.
  EXPECT_GT(j.dirac_p, 1e-4);
  const auto kept = static_cast<uint64_t>((1 - kGuiding.chance[1]) * smooth * kSamples);
  EXPECT_LT(binomial_p(kept, kSamples, smooth), kWrong);
}

// A step by the BSDF keeps the probability that it has in a plain walk, and a guided one comes on
// top. What a walk carries grows only where it leaves a light.
TEST(guide, no_walk_carries_more_after_a_surface_than_before) {
  const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/three-rooms.glb");
  const Vista vista(scene, scene.camera(""), 16, 12,
                    {rectangle({4.15, 0.75, -0.25}, {0, 0, 0.5}, {0, 0.5, 0}),
                     rectangle({2.05, 0.75, -0.25}, {0, 0, 0.5}, {0, 0.5, 0})});
  const Guide guide(vista, tdpt_guided.mixture);
  RayCounts rays;
  Walk walk;
  int longest = 0;
  for (const From from : {From::light, From::camera})
    for (uint64_t i = 0; i < 1000; ++i) {
      const Sequence numbers(3, 1, 0, i);
      if (from == From::light)
        walk_from_light(vista, guide, 64, numbers, walk, rays);
      else
        walk_from_camera(vista, guide, vista.view.film, 8, 6, 64, numbers, walk, rays);
      longest = std::max(longest, walk.size);
      for (int j = 2; j < walk.size; ++j)
        EXPECT_LE(max_component(walk.state(j).throughput),
                  (1 + 1e-5f) * max_component(walk.state(j - 1).throughput));
    }
  EXPECT_GT(longest, 15);
}

}  // namespace tdpt::guide_test
