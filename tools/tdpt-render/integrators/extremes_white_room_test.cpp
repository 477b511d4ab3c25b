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
  double radiance = 1;
  Mesh walls = open_box(kLow, kHigh);
  Mesh top = ceiling(kLow, kHigh);
  std::vector<Portal> portals{rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2})};
  Vec3d from{-0.9, 1.2, 0.1}, to{0, 0.7, 0};
  double yfov = 1;
  int width = 8, height = 6;
  uint64_t samples = 192, runs = 16;
  std::vector<const Integrator*> integrators{&nee, &bdpt, &tdpt_ref, &tdpt_guided};
  nlohmann::ordered_json placed = {};  ///< the node above all others
  /// Share of light lost in paths beyond the longest: white walls reflect for long.
  double lost = 0;

  void stands(const Mesh& mesh) { parts.add(mesh, white); }
  Scene read() {
    parts.add(walls, white);
    parts.add(top, parts.lamp(radiance));
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

Mesh sphere(const Vec3d& centre, double radius, bool inside_out) {
  Mesh mesh;
  const auto at = [&](int i, int j) {
    const double a = std::numbers::pi * i / 8, b = 2 * std::numbers::pi * j / 16;
    return centre +
           Vec3d(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)) * radius;
  };
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 16; ++j)
      for (const Cornered& t : Mesh{{at(i, j), at(i, j + 1), at(i + 1, j + 1)},
                                    {at(i, j), at(i + 1, j + 1), at(i + 1, j)}})
        mesh.push_back(inside_out ? Cornered{t.a, t.c, t.b} : t);
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
void sees(Room& room, const Vec3d& from, const Vec3d& to) {
  room.from = from;
  room.to = to;
}
void through(Room& room, std::vector<Portal> portals) {
  room.portals = std::move(portals);
}
/// A wall in the middle with a hole and a portal 0.8 m wide.
void divided(Room& room) {
  room.stands(wall_with_hole(0.6, 1.4, -0.4, 0.4));
  room.portals = {rectangle({0, 0.6, -0.4}, {0, 0, 0.8}, {0, 0.8, 0})};
}

const std::vector<Extreme> kExtremes{
    {"as_it_is", [](Room&) {}},
    // Units, place, rotations, scales.
    {"in_units_of_1e_6", [](Room& r) { scaled(r, 1e-6, 1e-6, 1e-6); }},
    {"in_units_of_1e6", [](Room& r) { scaled(r, 1e6, 1e6, 1e6); }},
    {"1e7_sizes_away", [](Room& r) { moved(r, 2e7); }},
    {"rotated",
     [](Room& r) {
       r.placed["rotation"] = {0.1, 0.7, -0.3, 0.64}, r.portals.clear();
     }},
    {"flat_1_to_1000", [](Room& r) { scaled(r, 1, 1e-3, 1); }},
    {"scaled_unevenly", [](Room& r) { scaled(r, 3, 0.5, 1.5); }},
    {"mirrored", [](Room& r) { scaled(r, -1, 1, 1); }},
    {"mirrored_thrice", [](Room& r) { scaled(r, -1, -2, -1); }},
    // At the horizon.
    {"a_triangle_5000_sizes_away",
     [](Room& r) {
       r.stands({{{1e4, 0, 3e3}, {1e4, 1, 3e3}, {1e4, 0, 3e3 + 1}}});
     }},
    {"a_triangle_5e6_sizes_away",
     [](Room& r) {
       r.stands({{{0, -1e7, 0}, {5, -1e7, 0}, {0, -1e7, 5}}});
     }},
    {"a_ground_of_50000_sizes_below",
     [](Room& r) {
       r.stands(sheet({-5e4, -0.2, -5e4}, {0, 0, 1e5}, {1e5, 0, 0}));
     }},
    {"a_dome_5000_sizes_around",
     [](Room& r) {
       r.stands(sphere({20, -30, 10}, 1e4, true));
     }},
    // Triangles.
    {"with_triangles_of_area_0",
     [](Room& r) {
       r.stands({{{0, 1, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 0, 0}, {0.2, 0.2, 0}, {0.4, 0.4, 0}}});
     }},
    {"with_triangles_of_area_1e_12", [](Room& r) { r.stands(crumbs(1.4e-6)); }},
    {"with_needles_of_1e6_to_1",
     [](Room& r) {
       r.stands(sheet({-1, 0.5, 0}, {2, 0, 0}, {0, 2e-6, 0}));
     }},
    {"floor_of_10000_strips",
     [](Room& r) {
       r.walls.erase(r.walls.begin() + 4, r.walls.begin() + 6), r.stands(needles(10000));
     }},
    {"walls_that_are_there_twice", [](Room& r) { r.walls = r.walls + r.walls; }},
    {"coplanar_sheets",
     [](Room& r) {
       r.stands(sheet({-0.5, 0, -0.5}, {0, 0, 1.7}, {1.7, 0, 0}) +
                sheet({-1, 0.2, -2}, {0, 1, 0}, {0, 0, 4}));
     }},
    {"sheets_through_each_other_and_the_walls",
     [](Room& r) {
       r.stands(sheet({-0.2, -0.5, -1.5}, {0.3, 1.5, 0.2}, {0.1, 0.1, 3}) +
                sheet({-0.2, 0.8, -0.5}, {2, 0.1, 0}, {0, -0.5, 0.7}));
     }},
    {"wall_without_thickness_with_a_hole", divided},
    {"t_junctions",
     [](Room& r) {  // four strips of the floor, cut at a third of their length; the walls stay
                    // uncut
       r.walls.erase(r.walls.begin() + 4, r.walls.begin() + 6);
       for (int i = 0; i < 4; ++i)
         r.stands(sheet({-1, 0, -1 + 0.5 * i}, {0, 0, 0.5}, {0.3 + 0.31 * i, 0, 0}) +
                  sheet({-0.7 + 0.31 * i, 0, -1 + 0.5 * i}, {0, 0, 0.5}, {1.7 - 0.31 * i, 0, 0}));
       r.placed["rotation"] = {0.1, 0.7, -0.3, 0.64};
       r.portals.clear();
     }},
    {"a_sphere",
     [](Room& r) {
       r.stands(sphere({0.3, 0.6, 0}, 0.5, false));
     }},
    {"a_sphere_inside_out",
     [](Room& r) {
       r.stands(sphere({0.3, 0.6, 0}, 0.5, true));
     }},
    // Portals.
    {"portal_touches_walls",
     [](Room& r) {
       divided(r), through(r, {rectangle({0, 0.6, -0.4}, {0, 0, 1.4}, {0, 0.8, 0})});
     }},
    {"portal_reaches_into_a_wall",
     [](Room& r) {
       divided(r), through(r, {rectangle({-0.2, 0.6, -0.4}, {0.4, 0, 0.8}, {0, 0.8, 0})});
     }},
    {"portal_reaches_beyond_the_room",
     [](Room& r) {
       divided(r), through(r, {rectangle({0, -1, -2}, {0, 0, 4}, {0, 4, 0})});
     }},
    {"portal_of_area_0",
     [](Room& r) {
       divided(r), through(r, {{"flat", {{0, 1, 0}, {0, 1, 0}, {0, 1.2, 0}}, {{0, 1, 2}}, {}}});
     }},
    {"portal_folded",
     [](Room& r) {
       divided(r);
       Portal half = rectangle({0, 0.6, -0.4}, {0, 0, 0.4}, {0, 0.8, 0});
       through(r, {half, rectangle({0, 0.6, 0}, {0.3, 0, 0.3}, {0, 0.8, 0})});
     }},
    {"portal_with_its_back_to_the_camera",
     [](Room& r) {
       divided(r), through(r, {rectangle({0, 0.6, -0.4}, {0, 0.8, 0}, {0, 0, 0.8})});
     }},
    {"portal_twice_the_same",
     [](Room& r) {
       divided(r), through(r, {r.portals[0], r.portals[0]});
     }},
    {"camera_in_the_opening",
     [](Room& r) {
       divided(r), sees(r, {0, 1, 0}, {-1, 1, 0});
     }},
    {"camera_looks_along_the_opening",
     [](Room& r) {
       divided(r), sees(r, {0, 1, 0}, {0, 1, 1});
     }},
    {"camera_in_the_portals_plane",
     [](Room& r) {
       divided(r), sees(r, {0, 0.3, 0}, {-1, 1, 0});
     }},
    {"camera_behind_the_portal",
     [](Room& r) {
       divided(r), sees(r, {0.7, 1.3, 0}, {-1, 1, 0});
     }},
    {"lamp_in_the_opening",
     [](Room& r) {
       divided(r),
           r.parts.add(sheet({0, 0.8, -0.2}, {0, 0, 0.4}, {0, 0.4, 0}), r.parts.lamp(1, true));
     }},
    // Radiance and surfaces.
    {"radiance_1e_30", [](Room& r) { r.radiance = 1e-30; }},
    {"radiance_1e30", [](Room& r) { r.radiance = 1e30; }},
    {"100_352_lamps",
     [](Room& r) {
       r.top.clear();
       for (int i = 0; i < 224; ++i)
         for (int j = 0; j < 224; ++j)
           r.top = std::move(r.top) +
                   sheet({-1 + i / 112.0, 2, -1 + j / 112.0}, {1 / 112.0, 0, 0}, {0, 0, 1 / 112.0});
     }},
    {"metal_of_roughness_0", [](Room& r) { metal(r, 0, 0.01); }},
    {"metal_of_roughness_1e_6", [](Room& r) { metal(r, 1e-6, 0.01); }},
    {"metal_of_roughness_0_02", [](Room& r) { metal(r, 0.02, 0.01); }},
    // Pictures.
    {"picture_of_1_pixel", [](Room& r) { r.width = r.height = 1; }},
    {"picture_of_16384_x_1",
     [](Room& r) { r.width = 16384, r.height = 1, r.runs = 3, r.integrators = {&tdpt_guided}; }},
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
  const double L = room.radiance;
  const Scene scene = room.read();
  const Vista vista(scene, scene.camera(""), room.width, room.height, room.portals);
  const MeanAndError by_pt = rendered(vista, pt, spp_of(vista, 48), 2);
  EXPECT_NEAR(by_pt.mean / L, 1, 1e-5 + room.lost);
  for (const Integrator* integrator : room.integrators) {
    const MeanAndError r = rendered(vista, *integrator, spp_of(vista, room.samples), room.runs);
    std::printf("%-11s %8.4f +- %.4f\n", integrator->name, r.mean / L, r.error / L);
    EXPECT_LT(std::abs(r.mean - L), 6 * r.error + (1e-5 + room.lost) * L) << integrator->name;
    EXPECT_LT(r.error, 0.15 * L) << integrator->name;
  }
}

INSTANTIATE_TEST_SUITE_P(extremes, white_room, ::testing::ValuesIn(kExtremes),
                         [](const auto& row) { return std::string(row.param.name); });

// A crack of a thousandth of the wall.
TEST(white_room_twin, a_leak_is_caught) {
  Room room;
  room.walls = open_box(kLow, {0.999, 2, 1});
  room.walls.erase(room.walls.begin() + 2, room.walls.begin() + 4);
  room.stands(sheet({1, 0, -1}, {0, 0, 2}, {0, 2, 0}));
  const Scene scene = room.read();
  const Vista vista(scene, scene.camera(""), room.width, room.height, {});
  EXPECT_LT(rendered(vista, pt, 64, 2).mean, 1 - 1e-4);
}

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
  for (const Integrator* integrator : integrators_under_test()) {
    EXPECT_EQ(light_in_box({4, 3, 4}, {}, 0, *integrator), 0) << integrator->name;
    // Long and narrow: a thousand times as much of the walls lies at their edges.
    EXPECT_EQ(light_in_box({4, 0.008, 0.006}, {}, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4, 0.02, 0.03}, turned, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4e3, 8, 6}, {}, 0, *integrator), 0) << integrator->name;
    EXPECT_EQ(light_in_box({4e-3, 8e-6, 6e-6}, {}, 0, *integrator), 0) << integrator->name;
  }
}
TEST(white_room_twin, a_crack_of_a_hundredth_is_caught) {
  for (const Integrator* integrator : integrators_under_test())
    EXPECT_GT(light_in_box({4, 0.008, 0.006}, {}, 8e-5, *integrator), 0) << integrator->name;
}

TEST(white_room_twin, a_portal_density_off_by_a_fifth_is_caught) {
  Room room;
  const Scene scene = room.read();
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
  EXPECT_NE(plain, picture_of([](Room& r) { scaled(r, 1, 1, 1.001); }));  // twin
}

double largest_difference(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, double{max_component(max(a[i] - b[i], b[i] - a[i]))});
  return largest;
}

// The same paths; rounding moves the camera by 1e-9.
TEST(white_room, moved_by_1e7_sizes_away_has_the_same_pixels) {
  const std::vector<Rgb> plain = picture_of([](Room&) {});
  EXPECT_LT(largest_difference(plain, picture_of([](Room& r) { moved(r, 2e7); })), 1e-5);
  EXPECT_GT(largest_difference(plain, picture_of([](Room& r) { scaled(r, 1, 1, 1.001); })), 1e-3);
}

// The frame is that of the room: nothing is rounded otherwise.
TEST(white_room, a_triangle_at_the_horizon_changes_no_byte) {
  const std::vector<Rgb> plain = picture_of([](Room&) {});
  EXPECT_EQ(plain, picture_of([](Room& r) {
              r.stands({{{1e4, -3, 1e4}, {1e4, -2, 1e4}, {1e4, -3, 1e4 + 1}}});
            }));
  EXPECT_EQ(plain, picture_of([](Room& r) {
              r.stands({{{0, -5e6, 0}, {1, -5e6, 0}, {0, -5e6, 1}}});
            }));
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
  EXPECT_NE(said[0].find("passes what stands around the cameras, at an angle to all axes: rays "
                         "start 0.03 m off surfaces, and the picture is wrong by about 1 %"),
            std::string::npos)
      << said[0];
}

// Doubles hold positions to 1e-16 of their distance, a file's floats to 1e-7.
TEST(far_from_the_origin, what_rounding_leaves_of_a_scene_is_said) {
  const auto warnings = [](double places, double node) {
    SceneParts parts;
    const int grey = parts.material(0.5);
    parts.add(open_box(kLow + Vec3d(places), kHigh + Vec3d(places)), grey);
    parts.camera({places, places + 1, places}, {places, places, places});
    parts.below({{"translation", {node, 0, 0}}});
    return parts.read().warnings;
  };
  for (const auto& [places, node] : {std::pair{0.0, 0.0}, {0.0, 2e7}, {0.0, 1e11}, {1000.0, 0.0}})
    EXPECT_TRUE(warnings(places, node).empty()) << places << " " << node;
  ASSERT_EQ(warnings(0, 4e15).size(), 1u);
  EXPECT_EQ(warnings(0, 4e15)[0],
            "the scene lies so far from the origin that its vertices are known to 0.4 m only, 0.2 "
            "of its size");
  EXPECT_EQ(warnings(1e5, 0).size(), 1u);
}

}  // namespace tdpt::extremes_white_room_test
