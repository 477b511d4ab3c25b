// Extreme units, places, shapes, triangles, portals, materials, cameras and pictures, each in a
// white room [testing/extremes.h], which must show the radiance of its ceiling.
//
// A path tracer's samples are all equal there and reveal leaks and losses of 1e-5; those of
// techniques that connect walks vary, and reveal wrong densities.
#include "tools/tdpt-render/testing/extremes.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt::extremes_white_room_test {

const Vec3d kLow{-1, 0, -1}, kHigh{1, 2, 1};

struct Room {
  SceneParts parts;
  int white = parts.material(1);
  Mesh walls = open_box(kLow, kHigh);
  Mesh top = ceiling(kLow, kHigh);
  std::vector<Portal> portals{rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2})};
  Vec3d from{-0.9, 1.2, 0.1}, to{0, 0.7, 0};
  double yfov = 1;
  int width = 8, height = 6;
  uint64_t samples = 192, runs = 16;
  std::vector<const Integrator*> integrators{&bdpt, &tdpt_guided};
  nlohmann::ordered_json placed = {};  ///< the node above all others
  /// Share of light lost in paths beyond the longest: white walls reflect for long.
  double lost = 0;

  void stands(const Mesh& mesh) { parts.add(mesh, white); }
  Scene read() {
    parts.add(walls, white);
    parts.add(top, parts.lamp(1));
    parts.camera(from, to, yfov);
    if (!placed.empty()) parts.below(placed);
    return parts.read();
  }
};

struct Extreme {
  const char* name;
  void (*make)(Room&);
};

void PrintTo(const Extreme& extreme, std::ostream* out) {
  *out << extreme.name;
}

class white_room : public ::testing::TestWithParam<Extreme> {};

Mesh sphere_inside_out(const Vec3d& centre, double radius) {
  Mesh mesh;
  const auto at = [&](int i, int j) {
    const double a = std::numbers::pi * i / 8, b = 2 * std::numbers::pi * j / 16;
    return centre +
           Vec3d(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)) * radius;
  };
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 16; ++j)
      mesh = std::move(mesh) + Mesh{{at(i, j), at(i + 1, j + 1), at(i, j + 1)},
                                    {at(i, j), at(i + 1, j), at(i + 1, j + 1)}};
  return mesh;
}

/// The floor as `n` strips from wall to wall.
Mesh needles(int n) {
  Mesh mesh;
  for (int i = 0; i < n; ++i)
    mesh = std::move(mesh) + sheet({-1, 0, -1 + 2.0 * i / n}, {0, 0, 2.0 / n}, {2, 0, 0});
  return mesh;
}

/// The mesh plus small triangles of that size about the room.
Mesh crumbs(double size) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p{-0.95 + 0.0019 * i, 0.1 + 1.8 * ((i * 7) % 97) / 97,
                  -0.9 + 1.8 * ((i * 5) % 89) / 89};
    mesh.push_back({p, p + Vec3d(size, 0, 0), p + Vec3d(0, 0, size)});
  }
  return mesh;
}

void scaled(Room& room, double x, double y, double z) {
  room.placed["scale"] = {x, y, z};
  room.portals[0] = rectangle(Vec3d(-x, y, -z), Vec3d(2 * x, 0, 0), Vec3d(0, 0, 2 * z));
}
void moved(Room& room, double by) {
  room.placed["translation"] = {by, -by, by};
  for (Portal& portal : room.portals)
    for (Vec3d& v : portal.vertices) v += Vec3d(by, -by, by);
}
void metal(Room& room, double roughness, double lost) {
  room.white = room.parts.material(1, {{"metallicFactor", 1}, {"roughnessFactor", roughness}});
  room.lost = lost;
}
/// A wall in the middle with a hole and a portal 0.8 m wide.
void divided(Room& room) {
  room.stands(wall_with_hole(0.6, 1.4, -0.4, 0.4));
  room.portals = {rectangle({0, 0.6, -0.4}, {0, 0, 0.8}, {0, 0.8, 0})};
}

void far_things(Room& room) {
  room.stands(sheet({-5e4, -0.2, -5e4}, {0, 0, 1e5}, {1e5, 0, 0}) +
              Mesh{{{0, -1e7, 0}, {5, -1e7, 0}, {0, -1e7, 5}}});
}
/// Of area 0 and 1e-12, needles of 1e6 to 1, twice in one place, coplanar, through each other and
/// the walls, inside out.
void bad_triangles(Room& room) {
  room.walls = room.walls + room.walls;
  room.stands(crumbs(1.4e-6) + sphere_inside_out({0.3, 0.6, 0}, 0.5) +
              Mesh{{{0, 1, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 0, 0}, {0.2, 0.2, 0}, {0.4, 0.4, 0}}} +
              sheet({-1, 0.5, 0}, {2, 0, 0}, {0, 2e-6, 0}) +
              sheet({-0.5, 0, -0.5}, {0, 0, 1.7}, {1.7, 0, 0}) +
              sheet({-1, 0.2, -2}, {0, 1, 0}, {0, 0, 4}) +
              sheet({-0.2, -0.5, -1.5}, {0.3, 1.5, 0.2}, {0.1, 0.1, 3}) +
              sheet({-0.2, 0.8, -0.5}, {2, 0.1, 0}, {0, -0.5, 0.7}));
}
/// Four strips of the floor, cut at a third of their length; the walls stay uncut. Rotated, so that
/// corners are rounded.
void t_junctions(Room& room) {
  room.walls.erase(room.walls.begin() + 4, room.walls.begin() + 6);
  for (int i = 0; i < 4; ++i)
    room.stands(sheet({-1, 0, -1 + 0.5 * i}, {0, 0, 0.5}, {0.3 + 0.31 * i, 0, 0}) +
                sheet({-0.7 + 0.31 * i, 0, -1 + 0.5 * i}, {0, 0, 0.5}, {1.7 - 0.31 * i, 0, 0}));
  room.placed["rotation"] = {0.1, 0.7, -0.3, 0.64};
  room.portals.clear();
}
void strips(Room& room) {
  room.walls.erase(room.walls.begin() + 4, room.walls.begin() + 6);
  room.stands(needles(10000));
}
/// One that reaches into a wall, one of area 0, and a folded one as its planes.
void wrong_portals(Room& room) {
  divided(room);
  room.portals = {rectangle({-0.2, 0.6, -0.4}, {0.4, 0, 0.8}, {0, 0.8, 0}),
                  {"flat", {{0, 1, 0}, {0, 1, 0}, {0, 1.2, 0}}, {{0, 1, 2}}, {}},
                  rectangle({0, 0.6, -0.4}, {0, 0, 0.4}, {0, 0.8, 0}),
                  rectangle({0, 0.6, 0}, {0.3, 0, 0.3}, {0, 0.8, 0})};
}
/// In the portal's plane, too.
void camera_in_the_opening(Room& room) {
  divided(room);
  room.from = {0, 1, 0};
  room.to = {-1, 1, 0};
}
void lamp_in_the_opening(Room& room) {
  divided(room);
  room.parts.add(sheet({0, 0.8, -0.2}, {0, 0, 0.4}, {0, 0.4, 0}), room.parts.lamp(1, true));
}
void many_lamps(Room& room) {
  room.top.clear();
  for (int i = 0; i < 224; ++i)
    for (int j = 0; j < 224; ++j)
      room.top = std::move(room.top) +
                 sheet({-1 + i / 112.0, 2, -1 + j / 112.0}, {1 / 112.0, 0, 0}, {0, 0, 1 / 112.0});
}
void wide_picture(Room& room) {
  room.width = 16384, room.height = 1;
  room.runs = 3;
  room.integrators = {&tdpt_guided};
}

const std::vector<Extreme> kExtremes{
    {"as_it_is", [](Room&) {}},
    {"in_units_of_1e_6", [](Room& r) { scaled(r, 1e-6, 1e-6, 1e-6); }},
    {"in_units_of_1e6", [](Room& r) { scaled(r, 1e6, 1e6, 1e6); }},
    {"1e7_sizes_away", [](Room& r) { moved(r, 2e7); }},
    {"flat_1_to_1000", [](Room& r) { scaled(r, 1, 1e-3, 1); }},
    {"mirrored_and_stretched", [](Room& r) { scaled(r, -1, -2, -1); }},
    {"far_things_at_the_horizon", far_things},
    {"bad_triangles", bad_triangles},
    {"floor_of_10000_strips", strips},
    {"t_junctions_rotated", t_junctions},
    {"wrong_portals", wrong_portals},
    {"camera_in_the_opening_of_a_thin_wall", camera_in_the_opening},
    {"lamp_in_the_opening", lamp_in_the_opening},
    {"100_352_lamps", many_lamps},
    {"metal_of_roughness_0", [](Room& r) { metal(r, 0, 0.01); }},
    {"metal_of_roughness_0_02", [](Room& r) { metal(r, 0.02, 0.01); }},
    {"picture_of_1_pixel", [](Room& r) { r.width = r.height = 1; }},
    {"picture_of_16384_x_1", wide_picture},
    {"field_of_view_0_001", [](Room& r) { r.yfov = 0.001 * std::numbers::pi / 180; }},
    {"field_of_view_179", [](Room& r) { r.yfov = 179 * std::numbers::pi / 180; }},
};

uint64_t spp_of(const Vista& vista, uint64_t samples) {
  const auto pixels = static_cast<uint64_t>(vista.view.film.width() * vista.view.film.height());
  return std::max<uint64_t>(1, samples / pixels);
}

TEST_P(white_room, shows_the_radiance_of_its_ceiling) {
  Room room;
  GetParam().make(room);
  const Scene scene = room.read();
  const Vista vista(scene, scene.camera(""), room.width, room.height, room.portals);
  const MeanAndError by_pt = rendered(vista, pt, spp_of(vista, 48), 2);
  EXPECT_NEAR(by_pt.mean, 1, 1e-5 + room.lost);
  for (const Integrator* integrator : room.integrators) {
    const MeanAndError r = rendered(vista, *integrator, spp_of(vista, room.samples), room.runs);
    EXPECT_LT(std::abs(r.mean - 1), 6 * r.error + 1e-5 + room.lost) << integrator->name;
    EXPECT_LT(r.error, 0.15) << integrator->name;
  }
}

INSTANTIATE_TEST_SUITE_P(extremes, white_room, ::testing::ValuesIn(kExtremes),
                         [](const auto& row) { return std::string(row.param.name); });

// The light in a closed box under a sky, a sun and a lamp, with a portal in a wall and one through
// two. `apart`: of a wall from the others.
double light_in_box(const Vec3d& size, const nlohmann::ordered_json& placed, double apart,
                    const Integrator& integrator) {
  SceneParts parts;
  const Vec3d low = -0.5 * size, high = 0.5 * size;
  Mesh walls = open_box(low, {high.x, high.y - apart, high.z}) + ceiling(low, high);
  parts.add(walls, parts.material(0.7));
  parts.camera({0.9 * low.x, 0, 0}, {0, 0.1 * high.y, 0.2 * high.z});
  if (!placed.empty()) parts.below(placed);
  const std::vector<Sky::Sun> suns{sun_of({1, 2, 3}, 0.01, 10)};
  Scene scene = under(parts.read(), std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(1000)}}, 0, suns));
  scene.lights.resize(1);
  scene.lights[0].position = {-1.3, 1.2, 0.9};
  scene.lights[0].intensity = Rgb(100);
  std::vector<Portal> portals{rectangle(low, {size.x, 0, 0}, {0, size.y, 0}),
                              rectangle(1.1 * low, {0, 2.2 * size.y, 0}, {2.2 * size.x, 0, 0})};
  const Vista vista(scene, scene.camera(""), 8, 6, portals);
  return rendered(vista, integrator, 64, 1).mean;
}
TEST(white_room, closed_boxes_keep_light_out) {
  using Json = nlohmann::ordered_json;
  const Json turned = {{"rotation", {0.1, 0.7, -0.3, 0.64}}, {"translation", {30, -20, 10}}};
  for (const Integrator* integrator : {&nee, &tdpt_org, &tdpt_guided}) {
    EXPECT_EQ(light_in_box({4, 3, 4}, {}, 0, *integrator), 0) << integrator->name;
    // Long and narrow: a thousand times as much of the walls lies at their edges.
    EXPECT_EQ(light_in_box({4, 0.008, 0.006}, {}, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4, 0.02, 0.03}, turned, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4e3, 8, 6}, {}, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4e-3, 8e-6, 6e-6}, {}, 0, *integrator), 0) << integrator->name;
    // Twin: a crack of a hundredth.
    EXPECT_GT(light_in_box({4, 0.008, 0.006}, {}, 8e-5, *integrator), 0) << integrator->name;
  }
}

// Of a thousandth of the wall, and a portal density off by a fifth.
TEST(white_room_twin, a_leak_and_a_density_are_caught) {
  Room leaky, room;
  leaky.walls = open_box(kLow, {0.999, 2, 1});
  leaky.walls.erase(leaky.walls.begin() + 2, leaky.walls.begin() + 4);
  leaky.stands(sheet({1, 0, -1}, {0, 0, 2}, {0, 2, 0}));
  const Scene leak = leaky.read(), scene = room.read();
  EXPECT_LT(rendered(Vista(leak, leak.camera(""), 8, 6, {}), pt, 64, 2).mean, 1 - 1e-4);
  Vista vista(scene, scene.camera(""), room.width, room.height, room.portals);
  vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, 0.8);
  const MeanAndError r = rendered(vista, tdpt_ref, spp_of(vista, room.samples), room.runs);
  EXPECT_GT(std::abs(r.mean - 1), 6 * r.error);
}

std::vector<Rgb> picture_of(void (*make)(Room&)) {
  Room room;
  make(room);
  const Scene scene = room.read();
  const Vista vista(scene, scene.camera(""), room.width, room.height, room.portals);
  Job settings;
  settings.limits.spp = 4;
  return render(*renderer_under_test(vista), tdpt_org, settings).picture.pixels;
}

TEST(white_room, in_units_of_powers_of_two_has_the_same_bytes) {
  const std::vector<Rgb> plain = picture_of([](Room&) {});
  EXPECT_EQ(plain, picture_of([](Room& r) { scaled(r, 0x1p-20, 0x1p-20, 0x1p-20); }));
  EXPECT_EQ(plain, picture_of([](Room& r) { scaled(r, 0x1p20, 0x1p20, 0x1p20); }));
  // The frame is that of the room: with triangles at the horizon nothing is rounded otherwise.
  EXPECT_EQ(plain, picture_of([](Room& r) {
              r.stands({{{1e4, -3, 1e4}, {1e4, -2, 1e4}, {1e4, -3, 1e4 + 1}},
                        {{0, -5e6, 0}, {1, -5e6, 0}, {0, -5e6, 1}}});
            }));
}

// The same paths; rounding moves the camera by 1e-9.
TEST(white_room, moved_by_1e7_sizes_away_has_the_same_pixels) {
  const std::vector<Rgb> plain = picture_of([](Room&) {});
  const auto most_off = [&](const std::vector<Rgb>& other) {
    double most = 0;
    for (size_t i = 0; i < plain.size(); ++i)
      most = std::max(most, length(Vec3d(plain[i]) - Vec3d(other[i])));
    return most;
  };
  EXPECT_LT(most_off(picture_of([](Room& r) { moved(r, 2e7); })), 1e-5);
  EXPECT_GT(most_off(picture_of([](Room& r) { scaled(r, 1, 1, 1.001); })), 1e-3);  // twin
}

TEST(white_room, what_a_ground_at_an_angle_costs_is_said) {
  const auto warnings = [](const nlohmann::ordered_json& placed) {
    Room room;
    room.stands(sheet({-5e4, 0, -5e4}, {0, 0, 1e5}, {1e5, 0, 0}));
    room.placed = placed;
    return room.read().warnings;
  };
  EXPECT_TRUE(warnings({}).empty());
  EXPECT_TRUE(warnings({{"rotation", {0, 0.6, 0, 0.8}}}).empty());
  const std::vector<std::string> said = warnings({{"rotation", {0.1, 0.7, -0.3, 0.64}}});
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("the picture is wrong by about 1 %"), std::string::npos) << said[0];
}

}  // namespace tdpt::extremes_white_room_test
