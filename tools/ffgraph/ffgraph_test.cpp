// Networks of small hand-made scenes and of testdata/scenes: geometry of patches, etendue against
// closed forms, and the position of the minimum cut.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "libcommon/base/process.h"
#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"
#include "tools/ffgraph/patch_map.h"
#include "tools/ffgraph/rounds.h"

namespace tdpt::ffgraph_test {

// Axis-parallel unit box [0,1]^3 of twelve triangles that look inwards; corners shared.
Scene box() {
  Scene s;
  for (int k = 0; k < 8; ++k)
    s.positions.push_back({float(k & 1), float(k >> 1 & 1), float(k >> 2 & 1)});
  const auto quad = [&s](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    s.triangles.push_back({{a, b, c}, 0});
    s.triangles.push_back({{a, c, d}, 0});
  };
  quad(0, 4, 5, 1);  // y = 0
  quad(2, 3, 7, 6);  // y = 1
  quad(0, 2, 6, 4);  // x = 0
  quad(1, 5, 7, 3);  // x = 1
  quad(0, 1, 3, 2);  // z = 0
  quad(4, 6, 7, 5);  // z = 1
  s.materials.resize(1);
  return s;
}

// Every triangle of `s` split in four.
Scene subdivided(const Scene& s) {
  Scene fine = s;
  fine.triangles.clear();
  for (const Triangle& t : s.triangles) {
    std::array<uint32_t, 3> mid;
    for (size_t k = 0; k < 3; ++k) {
      mid[k] = static_cast<uint32_t>(fine.positions.size());
      fine.positions.push_back((s.positions[t.vertex[k]] + s.positions[t.vertex[(k + 1) % 3]]) *
                               0.5f);
    }
    for (size_t k = 0; k < 3; ++k)
      fine.triangles.push_back({{t.vertex[k], mid[k], mid[(k + 2) % 3]}, t.material});
    fine.triangles.push_back({mid, t.material});
  }
  return fine;
}

Scene room(const std::string& file) {
  return read_gltf(std::string(TDPT_TESTDATA) + "/scenes/" + file);
}

TEST(connectivity, each_wall_of_a_box_is_one_piece) {
  const auto c = surface_components(box());
  for (size_t t = 0; t < 12; ++t) EXPECT_EQ(c[t], c[t / 2 * 2]);
  EXPECT_EQ(*std::max_element(c.begin(), c.end()), 5u);
}

TEST(connectivity, does_not_depend_on_tessellation_or_on_doubled_vertices) {
  Scene s = subdivided(box());
  for (Triangle& t : s.triangles)
    for (uint32_t& v : t.vertex) {
      Vec3f copy = s.positions[v];
      if (copy.z == 0 && s.positions.size() % 2) copy.z = -0.0f;  // both zeros are one place
      v = static_cast<uint32_t>(s.positions.size());
      s.positions.push_back(copy);
    }
  const auto c = surface_components(s);
  EXPECT_EQ(*std::max_element(c.begin(), c.end()), 5u);
}

TEST(connectivity, ends_where_no_manifold_is_and_where_surfaces_do_not_touch) {
  Scene s = box();
  s.triangles.push_back(s.triangles[0]);
  for (int k = 0; k < 3; ++k) s.positions.push_back({float(k == 1), 0, float(k == 2) + 1e-3f});
  s.triangles.push_back({{8, 10, 9}, 0});
  const auto c = surface_components(s);
  EXPECT_NE(c[12], c[0]);
  EXPECT_NE(c[13], c[0]);
  EXPECT_EQ(c[1], c[0]);
}

// Adds the patches of `n` places all over it.
void fill(PatchMap& map, const Scene& s, int n) {
  Rng rng(9, 0, 0);
  for (int k = 0; k < n; ++k) {
    const uint32_t t = rng.below(static_cast<uint32_t>(s.triangles.size()));
    const double u = rng.uniform();
    const double v = rng.uniform();
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    const TriangleShape shape = shape_of(s, t);
    map.find_or_add(2 * t, shape.p0 + shape.e1 * b1 + shape.e2 * b2);
  }
}
PatchMap full_map(const Scene& s, double cell) {
  PatchMap map(s, {{-0.031, -0.017, -0.043}, cell}, surface_components(s));
  fill(map, s, 40000);
  return map;
}

double area_of(const Fragments& fragments) {
  double sum = 0;
  for (const auto& f : fragments.all()) sum += f.area;
  return sum;
}

TEST(fragments, of_a_box_add_up_to_its_area_and_hold_their_points) {
  const Scene s = box();
  const PatchMap map = full_map(s, 0.3);
  const Fragments fragments(map);
  EXPECT_NEAR(area_of(fragments), 6, 1e-9);
  int elsewhere = 0;
  for (uint32_t k = 0; k < 20000; ++k) {
    Rng rng(3, 0, k);
    const uint32_t f = rng.below(static_cast<uint32_t>(fragments.all().size()));
    const Fragments::Point p = fragments.sample(f, rng);
    elsewhere += map.find(fragments.all()[f].face, p.position) != p.patch;
  }
  EXPECT_LE(elsewhere, 2);  // exactly on the border of a cell
  // Cells that are split cover the same area.
  std::vector<uint8_t> chosen(map.size(), 0);
  for (size_t i = 0; i < chosen.size(); i += 3) chosen[i] = 1;
  PatchMap fine = map.split(chosen);
  EXPECT_EQ(fine.size(), 0u);
  fill(fine, s, 100000);
  EXPECT_NEAR(area_of(Fragments(fine)), 6, 0.01);
  EXPECT_GT(fine.size(), map.size());
}

// n_ij of floor and ceiling against A_i F_ij + A_j F_ji of parallel unit squares: 2 * 0.19982.
bool etendue_holds(const Scene& s, double fault) {
  const Tracer tracer(s);
  const PatchMap map = full_map(s, 0.3);
  const uint32_t rays = 80000;
  const Etendue e = measure_etendue(map, Fragments(map), tracer, 5, rays);
  const auto component = surface_components(s);
  const uint32_t low = 2 * component.front(), high = 2 * component[s.triangles.size() / 6];
  double count = 0;
  for (const Etendue::Pair& p : e.pairs) {
    const uint32_t a = map.keys()[p.i].piece, b = map.keys()[p.j].piece;
    if ((a == low && b == high) || (a == high && b == low)) count += p.count;
  }
  const double expected = rays * 2 * 0.19982 / 6 * fault;
  return std::abs(count - expected) < 4 * std::sqrt(expected);
}
TEST(etendue, of_parallel_walls_is_that_of_the_closed_form_however_they_are_divided) {
  EXPECT_TRUE(etendue_holds(box(), 1));
  EXPECT_TRUE(etendue_holds(subdivided(box()), 1));
  EXPECT_FALSE(etendue_holds(box(), 1.1));  // twin
}

TEST(straddling, is_what_sends_less_than_the_share_to_one_side) {
  Etendue e;
  e.pairs = {{0, 1, 91}, {0, 2, 9}, {1, 3, 9}};
  const std::vector<Side> side{Side::source, Side::source, Side::sink, Side::source};
  EXPECT_EQ(straddling(e, side, 0.92), (std::vector<uint8_t>{1, 0, 0, 0}));
  EXPECT_EQ(straddling(e, side, 0.90), (std::vector<uint8_t>{0, 0, 0, 0}));
}

struct Graph {
  Scene scene;
  LightFlow flow;
  GraphReport report;
  std::vector<uint8_t> on_source;
};

std::unique_ptr<Graph> graph_of(Scene scene, int rounds, uint64_t seed = 1) {
  auto g = std::make_unique<Graph>();
  g->scene = std::move(scene);
  GraphSettings settings;
  settings.walks = {seed, 20000, 12};
  settings.rays = 100000;
  settings.rounds = rounds;
  Phases phases;
  g->flow = build_graph(g->scene, {g->scene.camera("")}, settings, nullptr, g->report, phases);
  g->on_source = max_flow(g->flow.file.network).source_side;
  return g;
}

// From outside a room whose walls face inwards.
TEST(graph, of_a_camera_that_culls_begins_behind_the_wall) {
  const auto first_met = [](bool culls) {
    Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
    for (Material& m : scene.materials) m.double_sided = false;
    Camera& camera = scene.cameras[0];
    camera = {
        "outside", scene.frame.to_canonical({-1, 1, 0}), {0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 0.5, 1,
        culls};
    const Walks walks = camera_walks(scene, camera, Tracer(scene, culls), {1, 2000, 1});
    size_t backs = 0;
    for (const WalkHit& h : walks) backs += is_hit(h) && h.face % 2 == 1;
    return std::pair(hits_in(walks), backs);
  };
  EXPECT_EQ(first_met(true), std::pair(size_t{2000}, size_t{0}));
  EXPECT_EQ(first_met(false), std::pair(size_t{2000}, size_t{2000}));
}

// Share of independent rays between patches of the two sides that pass an axis-parallel box
// [metres]: the hole with its jambs.
double through(const Graph& g, const Vec3d& low, const Vec3d& high) {
  const Tracer tracer(g.scene);
  const Fragments fragments(g.flow.patches);
  std::vector<double> area;
  for (const auto& f : fragments.all()) area.push_back(f.area);
  const AliasTable table(area);
  double rays = 0, passed = 0;
  for (uint32_t k = 0; k < 200000; ++k) {
    Rng rng(77, 0, k);
    const uint32_t f = table.sample(rng.uniform());
    const Fragments::Point p = fragments.sample(f, rng);
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = Onb<double>(p.normal).to_world(cosine_hemisphere(u, v));
    Hit hit;
    if (!tracer.closest({p.position, p.normal}, w, hit)) continue;
    const uint32_t to =
        g.flow.patches.find(2 * hit.triangle + (dot(hit.normal, w) > 0 ? 1 : 0), hit.position);
    if (to == kNoPatch || g.on_source[to + 2] == g.on_source[p.patch + 2]) continue;
    rays += 1;
    const Vec3d a = g.scene.frame.to_metres(p.position), b = g.scene.frame.to_metres(hit.position);
    double enter = 0, leave = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = b[axis] - a[axis];
      const double t0 = (low[axis] - a[axis]) / d, t1 = (high[axis] - a[axis]) / d;
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    passed += enter < leave;
  }
  EXPECT_GT(rays, 100);
  return passed / rays;
}

TEST(cut, lies_in_the_hole_between_two_rooms) {
  const auto g = graph_of(room("two-rooms.glb"), 2);
  EXPECT_GT(through(*g, {1.999, 0.874, -0.126}, {2.101, 1.126, 0.126}), 0.95);
  EXPECT_LT(through(*g, {1.999, 0.3, -0.126}, {2.101, 0.55, 0.126}), 0.05);  // twin
}

// Share of the surface that is on the wrong side of a wall across x of the room's own frame, which
// `turn` turns back; but for the place of the door and its leaf.
double wrong_side(const Graph& g, double wall, double low, double high,
                  const std::function<Vec3d(const Vec3d&)>& turn) {
  double wrong = 0, all = 0;
  for (size_t i = 0; i < g.flow.file.patches.size(); ++i) {
    const Patch& p = g.flow.file.patches[i];
    const double x = turn(g.scene.frame.to_canonical(p.centre)).x;
    if (x > low && x < high) continue;
    all += p.samples;
    if ((x > wall) != (g.on_source[i + 2] != 0)) wrong += p.samples;
  }
  return wrong / all;
}
const auto as_it_is = [](const Vec3d& v) { return v; };

double flow_of(const Graph& g) {
  return static_cast<double>(max_flow(g.flow.file.network).value);
}

// Without refinement, patches that straddle the slit leak around the leaf of the door.
TEST(cut, refinement_takes_leaks_away_and_keeps_the_light_through_the_slit) {
  const auto coarse = graph_of(room("door-ajar.glb"), 0), fine = graph_of(room("door-ajar.glb"), 2);
  EXPECT_GT(fine->report.split(), 10u);
  EXPECT_EQ(fine->report.rounds[0].openings, 1u);
  EXPECT_LT(flow_of(*fine), 0.9 * flow_of(*coarse));
  const auto x_of = [&](double metres) {
    return fine->scene.frame.to_canonical(Vec3d(metres, 0, 0)).x;
  };
  EXPECT_LT(wrong_side(*fine, x_of(2.2), x_of(1.2), x_of(2.2), as_it_is), 0.01);
}

// The frame carries units and position, and patches are in metres; turned by 33 degrees about y,
// cells and bins of normals change. The wall is in the middle of the room's box.
TEST(cut, does_not_depend_on_place_units_turn_tessellation_and_brightness) {
  const Scene plain = room("two-rooms.glb");
  const double c = std::cos(0.576), s = std::sin(0.576);
  const auto turn = [c, s](const Vec3d& v) {
    return Vec3d(c * v.x + s * v.z, v.y, -s * v.x + c * v.z);
  };
  const auto turn_back = [c, s](const Vec3d& v) {
    return Vec3d(c * v.x - s * v.z, v.y, s * v.x + c * v.z);
  };
  Scene far = plain, millimetres = plain, turned = plain, fine = subdivided(plain);
  far.frame.centre += Vec3d(3e5, -2e5, 7e4);
  millimetres.frame.scale /= 1000;
  millimetres.frame.centre = millimetres.frame.centre * 1000;
  for (Vec3f& p : turned.positions) p = Vec3f(turn(Vec3d(p)));
  for (Camera& camera : turned.cameras)
    for (Vec3d* v : {&camera.position, &camera.right, &camera.up, &camera.forward}) *v = turn(*v);
  for (Material& m : fine.materials) m.emission = m.emission * 0.01f;
  double flow = 0;  // of the plain one
  for (const Scene* scene : std::vector<const Scene*>{&plain, &far, &millimetres, &turned, &fine}) {
    const auto g = graph_of(*scene, 0);
    EXPECT_LT(
        wrong_side(*g, 0, -0.1, 0.1,
                   scene == &turned ? std::function<Vec3d(const Vec3d&)>(turn_back) : as_it_is),
        0.01);
    if (scene == &plain) flow = flow_of(*g);
    EXPECT_NEAR(flow_of(*g) / flow, 1, 0.05);
  }
}

}  // namespace tdpt::ffgraph_test
