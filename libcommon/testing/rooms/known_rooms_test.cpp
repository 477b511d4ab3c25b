// Light walks through the generated rooms: the known openings, and nothing else, connect the
// camera's side to that of the lamps or the sky. And the scores of portals see what they should.
#include "libcommon/testing/rooms/known_rooms.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing::known_rooms_test {

// A fan of quads over the outline, slightly larger, so that its rim is inside the wall.
RoomPlan::Part filling(const KnownAperture& o) {
  Vec3d middle{};
  for (const Vec3d& p : o.outline) middle += p / static_cast<double>(o.outline.size());
  const auto at = [&](size_t i) {
    return middle + (o.outline[i % o.outline.size()] - middle) * 1.002;
  };
  RoomPlan::Part part{"filling", 0, {}};
  for (size_t i = 0; i < o.outline.size(); ++i) {
    const Vec3d a = at(i), b = at(i + 1);
    part.quads.push_back({middle, a, (a + b) * 0.5, b});
  }
  return part;
}

// Rays and diffuse walks in a room, in its own coordinates, with some openings filled.
class TracedRoom {
 public:
  explicit TracedRoom(const KnownRoom& room, const std::vector<KnownAperture>& filled = {})
      : camera_(room.plan.camera),
        scene_(scene_of(room.plan, filled)),
        tracer_(scene_),
        open_(room.kind >= sky_room_kinds().front()) {}

  bool sees(const Vec3d& a, const Vec3d& b) const {
    return tracer_.visible({scene_.frame.to_canonical(a)}, {scene_.frame.to_canonical(b)});
  }

  /// Number of walks from the camera that find light.
  int lights_found(int walks) const {
    int found = 0;
    for (int k = 0; k < walks; ++k) {
      Rng rng(6, 0, static_cast<uint64_t>(k));
      const double z = 2 * rng.uniform() - 1, t = 6.283185307179586 * rng.uniform();
      const double r = std::sqrt(1 - z * z);
      found += finds_light({camera_, {r * std::cos(t), r * std::sin(t), z}}, rng);
    }
    return found;
  }

  /// Of walks from the filled opening, to the side that its light goes to (1) or comes from (-1).
  int lights_found_from(const KnownAperture& o, double side) const {
    int found = 0;
    Rng rng(8, 0, 0);
    for (const Line& line : free_lines(o, 500)) {
      const Vec3d w = line.direction * side;
      found += finds_light({line.point + w * 1e-3, w}, rng);
    }
    return found;
  }

 private:
  static Scene scene_of(RoomPlan plan, const std::vector<KnownAperture>& filled) {
    for (const KnownAperture& o : filled) plan.parts.push_back(filling(o));
    return read_gltf(TempFolder().write("room.glb", plan.glb()));
  }

  // Whether a walk hits a lamp's front, or leaves to sky or sun, within 60 bounces.
  bool finds_light(const Line& start, Rng& rng) const {
    Tracer::Origin from{scene_.frame.to_canonical(start.point)};
    Vec3d w = start.direction;
    for (int bounce = 0; bounce < 60; ++bounce) {
      Hit hit;
      if (!tracer_.closest(from, w, hit)) return open_ && hit.triangle == ~0u;
      const bool front = dot(hit.normal, w) < 0;
      if (max_component(scene_.material_of(hit.triangle).emission) > 0) return front;
      const Vec3d n = front ? hit.normal : -hit.normal;
      const double a = rng.uniform(), b = rng.uniform();
      w = Onb<double>(n).to_world(cosine_hemisphere(a, b));
      from = {hit.position, n};
    }
    return false;
  }

  Vec3d camera_;
  Scene scene_;
  Tracer tracer_;
  bool open_;
};

std::vector<RoomKind> kinds_with_openings() {
  std::vector<RoomKind> kinds = all_room_kinds();
  kinds.insert(kinds.end(), sky_room_kinds().begin(), sky_room_kinds().end());
  std::erase(kinds, RoomKind::open_room);
  std::erase(kinds, RoomKind::landscape);
  std::erase(kinds, RoomKind::keyhole);  // hardly any walk passes it
  return kinds;
}

// Share of the lines through a room's openings that the scene blocks in or near the wall: within 6
// cm where slats or curtains hang, which lets a few hit the floor.
double share_stopped(const TracedRoom& room, const std::vector<KnownAperture>& openings,
                     double beyond) {
  int lines = 0, stopped = 0;
  for (const KnownAperture& o : openings)
    for (const Line& line : free_lines(o, 1000)) {
      const double reach = (0.5 * o.thickness + beyond) / dot(line.direction, o.normal);
      if (reach > 1) continue;  // so oblique that it hits furniture and corners
      ++lines;
      stopped +=
          !room.sees(line.point - line.direction * reach, line.point + line.direction * reach);
    }
  return lines > 0 ? static_cast<double>(stopped) / lines : 1;
}

void expect_light_through_known_openings_alone(uint64_t seed) {
  for (const RoomKind kind : kinds_with_openings()) {
    const KnownRoom room = known_room(kind, seed);
    const std::vector<KnownAperture>& openings = room.apertures;
    const TracedRoom open(room), filled(room, openings);
    EXPECT_EQ(filled.lights_found(2000), 0) << room.file();
    if (kind != RoomKind::hole && kind != RoomKind::holes_in_row) {  // too few walks find a hole
      EXPECT_GT(open.lights_found(2000), 0) << room.file();
    }
    // Beside a leaf lines begin on either side of the filling, and continue along it.
    if (kind == RoomKind::ajar || kind == RoomKind::ajar_full) continue;
    int behind = 0;
    for (const KnownAperture& o : openings) {
      EXPECT_EQ(filled.lights_found_from(o, 1), 0) << room.file();
      behind += filled.lights_found_from(o, -1);
    }
    EXPECT_GT(behind, 0) << room.file();
    const bool plain = openings[0].obstacles.empty() && openings[0].mouth.empty();
    EXPECT_LT(share_stopped(open, openings, plain ? 0.002 : 0.06), plain ? 0.02 : 0.05)
        << room.file();
  }
}
TEST(known_rooms, light_passes_the_known_openings_alone) {
  expect_light_through_known_openings_alone(7);
}
TEST(long_known_rooms, light_passes_the_known_openings_alone) {
  for (const uint64_t seed : {8, 9, 10}) expect_light_through_known_openings_alone(seed);
}

TEST(known_rooms, twin_one_opening_left_open_is_noticed) {
  for (const RoomKind kind :
       {RoomKind::two_openings, RoomKind::bay, RoomKind::skylight, RoomKind::colonnade}) {
    uint64_t seed = 1;
    while (known_room(kind, seed).apertures.size() < 2) ++seed;
    const KnownRoom room = known_room(kind, seed);
    for (size_t i = 0; i < room.apertures.size(); ++i) {
      std::vector<KnownAperture> others = room.apertures;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_GT(TracedRoom(room, others).lights_found(2000), 0) << room.file() << " " << i;
    }
  }
}

TEST(known_rooms, twin_slats_bars_and_furniture_that_are_kept_quiet_are_noticed) {
  for (const RoomKind kind : {RoomKind::glazing_bars, RoomKind::blinds, RoomKind::furnished_door,
                              RoomKind::curtains, RoomKind::sky_blinds}) {
    const KnownRoom room = known_room(kind, 7);
    std::vector<KnownAperture> bare = room.apertures;
    for (KnownAperture& o : bare) o.obstacles.clear(), o.mouth.clear();
    EXPECT_GT(share_stopped(TracedRoom(room), bare, 0.06), 0.1) << room.file();
  }
}

// The last opening is the door between the rooms: closing it alone keeps the camera's room dark,
// and so does closing only the windows.
TEST(known_rooms, of_a_room_behind_another_are_joined_through_both_walls) {
  const KnownRoom room = known_room(RoomKind::room_behind, 7);
  EXPECT_EQ(TracedRoom(room, {room.apertures.back()}).lights_found(2000), 0);
  std::vector<KnownAperture> windows = room.apertures;
  windows.pop_back();
  EXPECT_EQ(TracedRoom(room, windows).lights_found(2000), 0);
}

// ---- scores ----
Portal portal_of(const KnownAperture& o) {
  Portal portal;
  portal.vertices = o.outline;
  for (uint32_t i = 2; i < o.outline.size(); ++i) portal.triangles.push_back({0, i - 1, i});
  const Vec3d n = cross(o.outline[1] - o.outline[0], o.outline[2] - o.outline[0]);
  if (dot(n, o.normal) < 0)
    for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  return portal;
}

// An upright rectangle across x = 0, from (y, z); light passes it towards -x.
KnownAperture upright(double y, double z, double high, double wide, double thickness = 0) {
  return rectangle({0, y, z}, {0, high, 0}, {0, 0, wide}, {-1, 0, 0}, thickness);
}

bool right(const std::vector<KnownAperture>& found, const std::vector<KnownAperture>& openings) {
  std::vector<Portal> portals;
  for (const KnownAperture& o : found) portals.push_back(portal_of(o));
  return score(portals, openings).right();
}

TEST(portal_score, is_full_for_the_openings_themselves) {
  for (const RoomKind kind : kinds_with_openings()) {
    const KnownRoom room = known_room(kind, 2);
    EXPECT_TRUE(right(room.placed_apertures(), room.placed_apertures())) << room.file();
  }
}

TEST(portal_score, takes_any_plane_between_the_two_narrow_places_beside_a_leaf) {
  KnownAperture o = upright(0, 0, 2, 0.1);
  o.mouth = {{0, 0, 0}, {0, 2, 0}, {0.1, 2, 0.1}, {0.1, 0, 0.1}};  // turned by 45 degrees
  const double c = std::sqrt(0.5);
  EXPECT_NEAR(angle_to(o, {-c, 0, c}), 0, 1e-6);
  EXPECT_NEAR(angle_to(o, normalize(Vec3d{-2, 0, 1})), 0, 0.5);
  EXPECT_NEAR(angle_to(o, {0, 0, 1}), 45, 1e-6);
  EXPECT_NEAR(angle_to(o, {-c, 0, -c}), 45, 1e-6);
}

// A window of 1 x 1 with a cross of bars, 0.04 wide.
TEST(portal_score, takes_one_portal_or_one_for_each_pane) {
  KnownAperture o = upright(0, 0, 1, 1, 0.2);
  for (const double y : {0.0, 0.52})
    for (const double z : {0.0, 0.52}) o.panes.push_back(upright(y, z, 0.48, 0.48, 0.03));
  o.obstacles = box({-0.015, 0.48, 0}, {0.015, 0.52, 1});
  for (const Quad& q : box({-0.015, 0, 0.48}, {0.015, 1, 0.52})) o.obstacles.push_back(q);
  const std::vector<KnownAperture>& p = o.panes;
  EXPECT_TRUE(right({o}, {o}));
  EXPECT_TRUE(right(p, {o}));
  EXPECT_FALSE(right({o, p[0]}, {o}));
  EXPECT_FALSE(right({o, o}, {o}));
  EXPECT_FALSE(right({p[0], p[1], p[2]}, {o}));
  EXPECT_FALSE(right({p[0], p[1], p[2], p[2]}, {o}));
  EXPECT_FALSE(right({upright(0, 0, 1, 0.48), p[1], p[3]}, {o}));
}

TEST(portal_score, leaves_free_whether_what_obstacles_stop_is_covered) {
  KnownAperture o = upright(0, 0, 2, 0.8, 0.1);
  EXPECT_FALSE(right({upright(0.6, 0, 1.4, 0.8)}, {o}));
  o.obstacles = box({-0.3, 0, 0}, {0.3, 0.62, 0.8});
  EXPECT_TRUE(right({upright(0.6, 0, 1.4, 0.8)}, {o}));
  EXPECT_TRUE(right({o}, {o}));
  EXPECT_FALSE(right({upright(0.8, 0, 1.2, 0.8)}, {o}));
}

TEST(portal_score, asks_for_no_portal_where_it_is_optional) {
  KnownAperture o = upright(0, 0, 1, 1, 0.1);
  o.optional = true;
  EXPECT_TRUE(right({}, {o}));
  EXPECT_TRUE(right({o}, {o}));
  EXPECT_FALSE(right({o, o}, {o}));
  EXPECT_FALSE(right({o, upright(0, 3, 1, 1)}, {o}));
  EXPECT_FALSE(right({upright(0, 0, 1, 0.5)}, {o}));  // half of it is worse than none
  const KnownAperture door = upright(0, 5, 2, 1, 0.1);
  EXPECT_FALSE(right({}, {door, o}));
  EXPECT_TRUE(right({door}, {door, o}));
}

TEST(portal_score, sees_every_planted_fault) {
  const std::vector<KnownAperture> openings{upright(0, 0, 0.5, 0.5, 0.1)};
  const Portal good = portal_of(openings[0]);
  ASSERT_TRUE(score({good}, openings).right());
  const auto changed = [&](const auto& change) {
    Portal p = good;
    for (Vec3d& v : p.vertices) change(v);
    return score({p}, openings);
  };
  EXPECT_LT(changed([](Vec3d& v) { v.y += 0.05; }).coverage, 0.98);
  EXPECT_LT(changed([](Vec3d& v) { v.y *= 0.9; }).coverage, 0.98);
  EXPECT_LT(changed([](Vec3d& v) { v.y *= 1.3; }).tightness, 0.9);
  EXPECT_NEAR(changed([](Vec3d& v) { v.x += 0.07 * v.y; }).angle, 4, 0.1);
  Portal backwards = good, far = good;
  for (auto& t : backwards.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(score({backwards}, openings).coverage, 0);
  for (Vec3d& v : far.vertices) v.z += 3;
  EXPECT_EQ(score({good, far}, openings).strays, 1u);
  EXPECT_FALSE(score({good, good}, openings).right());
  EXPECT_FALSE(score({}, openings).right());
  EXPECT_EQ(score({good}, {}).strays, 1u);
}

TEST(portal_distance, is_that_of_shifted_squares) {
  const Portal a = portal_of(upright(0, 0, 1, 1));
  Portal b = a;
  for (Vec3d& v : b.vertices) v += Vec3d{0.4, 0.3, 0};
  EXPECT_NEAR(distance(a, a), 0, 1e-12);
  EXPECT_NEAR(distance(a, b), 0.5, 1e-12);
  b = portal_of(upright(0.2, 0.2, 0.1, 0.1));
  EXPECT_NEAR(distance(a, b), std::sqrt(2) * 0.7, 1e-12);  // from the far corner
  EXPECT_NEAR(distance_to_nearest(a, {b, a}), 0, 1e-12);
}

}  // namespace tdpt::testing::known_rooms_test
