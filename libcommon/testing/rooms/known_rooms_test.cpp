// Generated rooms are as they claim, and the scores detect what they should.
#include "libcommon/testing/rooms/known_rooms.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/portal_distance.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing::known_rooms_test {

struct Leaks {
  int rays = 0, through = 0, unexplained = 0, lost = 0;
};

// Among random rays near the openings, from well behind a wall across x to well before it: those
// that pass no known opening, and those that hit nothing.
Leaks leaks_of(const KnownRoom& room, const std::vector<KnownAperture>& openings) {
  const TempFolder folder;
  Writing writing = room.writing;
  writing.placement = {};
  const Scene scene = read_gltf(folder.write("room.glb", room.plan.glb(writing)));
  const Tracer tracer(scene);
  const bool row = openings.size() > 1 && openings[0].normal.x < -0.9 &&
                   std::abs(openings[0].outline[0].x - openings[1].outline[0].x) > 1;
  Leaks leaks;
  for (uint64_t k = 0; k < 300000; ++k) {
    Rng rng(5, 0, k);
    // Through random points around a random opening, so that many pass.
    const KnownAperture& o = openings[rng.below(static_cast<uint32_t>(openings.size()))];
    Vec3d middle{};
    double size = 0;
    for (const Vec3d& p : o.outline) middle += p / static_cast<double>(o.outline.size());
    for (const Vec3d& p : o.outline) size = std::max(size, length(p - middle));
    const double a = rng.uniform(), b = rng.uniform(), c = rng.uniform(), d = rng.uniform(),
                 e = rng.uniform();
    const Vec3d w = Onb<double>(o.normal).to_world(cosine_hemisphere(a, b));
    const Vec3d place = middle + Vec3d{c - 0.5, d - 0.5, e - 0.5} * (3 * size);
    Hit ahead, behind;
    const Vec3d at = scene.frame.to_canonical(place);
    const bool hit = tracer.closest({at}, w, ahead) && tracer.closest({at}, -w, behind);
    if (!hit) {
      ++leaks.lost;  // also points within walls or outside
      continue;
    }
    const Vec3d from = scene.frame.to_metres(behind.position);
    const Vec3d to = scene.frame.to_metres(ahead.position);
    ++leaks.rays;
    // From well behind the wall to well before it, including leaves.
    const double wall = o.outline[0].x, reach = 0.35;
    if (!(from.x > wall + reach && to.x < wall - reach)) continue;
    if (row && std::abs(to.x - from.x) > 10) continue;
    ++leaks.through;
    const bool known = std::any_of(openings.begin(), openings.end(), [&](const KnownAperture& k_) {
      KnownAperture loose = k_;
      loose.mouth.clear();
      return passes(loose, from, to - from);
    });
    leaks.unexplained += !known;
  }
  return leaks;
}

TEST(known_rooms, light_passes_their_walls_through_the_known_openings_alone) {
  for (const RoomKind kind :
       {RoomKind::hole,          RoomKind::slit,           RoomKind::floor_door,
        RoomKind::through_floor, RoomKind::ajar_full,      RoomKind::ajar,
        RoomKind::window,        RoomKind::two_openings,   RoomKind::holes_in_row,
        RoomKind::doors_in_row,  RoomKind::arch,           RoomKind::banister,
        RoomKind::glazing_bars,  RoomKind::blinds,         RoomKind::curtains,
        RoomKind::double_door,   RoomKind::furnished_door, RoomKind::l_room,
        RoomKind::alcove,        RoomKind::shared_edge}) {
    const KnownRoom room = known_room(kind, 7);
    const Leaks leaks = leaks_of(room, room.apertures);
    EXPECT_GT(leaks.through, 100) << room.file();
    EXPECT_LE(leaks.unexplained, leaks.through / 500) << room.file() << " " << leaks.through;
  }
}

TEST(known_rooms, twin_an_opening_that_is_kept_quiet_is_noticed) {
  const KnownRoom room = known_room(RoomKind::two_openings, 7);
  // The ray test around one opening also sees the other's light.
  KnownAperture shifted = room.apertures[0];
  for (Vec3d& p : shifted.outline) p += Vec3d{0, 0, 0.05};
  const Leaks leaks = leaks_of(room, {shifted});
  EXPECT_GT(leaks.unexplained, leaks.through / 20);
}

// The face of the wall on the room's side, which rays from the room cross first.
KnownAperture inner_face(KnownAperture o) {
  for (Vec3d& p : o.outline) p += o.normal * (0.5 * o.thickness);
  o.thickness = 0;
  return o;
}

// Diffuse walks from the camera, until they leave its room (even into a jamb): those that see the
// sky, and those of them that do so through no known opening.
Leaks sky_seen_from(const KnownRoom& room, const std::vector<KnownAperture>& openings) {
  const Scene scene = read_gltf(TempFolder().write("room.glb", room.plan.glb()));
  const Tracer tracer(scene);
  const auto any_of = [&](const auto& test) {
    return std::any_of(openings.begin(), openings.end(), test);
  };
  Leaks leaks;
  for (uint64_t k = 0; k < 20000; ++k) {
    Rng rng(9, 0, k);
    const double a = 2 * rng.uniform() - 1, b = 2 * rng.uniform() - 1, c = 2 * rng.uniform() - 1;
    Vec3d place = room.plan.camera, w = normalize(Vec3d{a, b, c});
    Tracer::Origin from{scene.frame.to_canonical(place)};
    for (int bounce = 0; bounce < 20; ++bounce) {
      ++leaks.rays;
      Hit hit;
      if (!tracer.closest(from, w, hit)) {
        ++leaks.through;
        leaks.unexplained += !any_of([&](const KnownAperture& o) { return passes(o, place, -w); });
        break;
      }
      const Vec3d to = scene.frame.to_metres(hit.position);
      if (any_of([&](const KnownAperture& o) {
            const KnownAperture face = inner_face(o);
            return passes(face, place, -w) && dot(to - face.outline[0], o.normal) < -1e-4;
          }))
        break;
      const Vec3d n = dot(hit.normal, w) < 0 ? hit.normal : -hit.normal;
      const double u = rng.uniform(), v = rng.uniform();
      w = Onb<double>(n).to_world(cosine_hemisphere(u, v));
      place = to;
      from = {hit.position, n};
    }
  }
  return leaks;
}

TEST(known_rooms, see_the_sky_through_the_known_openings_alone) {
  for (const RoomKind kind : sky_room_kinds()) {
    if (kind == RoomKind::landscape) continue;
    const KnownRoom room = known_room(kind, 7);
    const Leaks leaks = sky_seen_from(room, room.apertures);
    EXPECT_GT(leaks.through, 30) << room.file();
    EXPECT_LE(leaks.unexplained, leaks.through / 500) << room.file() << " " << leaks.through;
  }
}

TEST(known_rooms, twin_a_window_elsewhere_than_said_is_noticed) {
  for (const RoomKind kind : {RoomKind::sky_window, RoomKind::skylight, RoomKind::colonnade}) {
    const KnownRoom room = known_room(kind, 7);
    std::vector<KnownAperture> shifted = room.apertures;
    for (KnownAperture& o : shifted)
      for (Vec3d& p : o.outline) p += Vec3d{0, 0, 0.1};
    const Leaks leaks = sky_seen_from(room, shifted);
    EXPECT_GT(leaks.unexplained, leaks.through / 20) << room.file();
  }
}

std::vector<RoomKind> every_kind() {
  std::vector<RoomKind> kinds = all_room_kinds();
  kinds.insert(kinds.end(), sky_room_kinds().begin(), sky_room_kinds().end());
  return kinds;
}

TEST(known_rooms, come_again_from_the_same_seed) {
  for (const RoomKind kind : every_kind()) {
    const KnownRoom a = known_room(kind, 3), b = known_room(kind, 3);
    EXPECT_EQ(a.plan.glb(a.writing), b.plan.glb(b.writing));
    EXPECT_NE(a.plan.glb(a.writing), known_room(kind, 4).plan.glb(a.writing));
  }
}

Portal portal_of(const KnownAperture& o) {
  Portal portal;
  portal.vertices = o.outline;
  for (uint32_t i = 2; i < o.outline.size(); ++i) portal.triangles.push_back({0, i - 1, i});
  const Vec3d n = cross(o.outline[1] - o.outline[0], o.outline[2] - o.outline[0]);
  if (dot(n, o.normal) < 0)
    for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  return portal;
}

TEST(portal_score, is_full_for_the_opening_itself) {
  for (const RoomKind kind : every_kind()) {
    const KnownRoom room = known_room(kind, 2);
    const std::vector<KnownAperture> openings = room.placed_apertures();
    std::vector<Portal> portals;
    for (const KnownAperture& o : openings) portals.push_back(portal_of(o));
    const PortalScore s = score(portals, openings);
    EXPECT_TRUE(s.right()) << room.file() << " " << s.coverage << " " << s.tightness << " "
                           << s.angle << " " << s.matched;
  }
}

TEST(portal_score, takes_any_plane_between_the_two_narrow_places_beside_a_leaf) {
  KnownAperture o = rectangle({0, 0, 0}, {0, 2, 0}, {0, 0, 0.1}, {-1, 0, 0}, 0);
  o.mouth = {{0, 0, 0}, {0, 2, 0}, {0.1, 2, 0.1}, {0.1, 0, 0.1}};  // turned by 45 degrees
  const double c = std::sqrt(0.5);
  EXPECT_NEAR(angle_to(o, {-1, 0, 0}), 0, 1e-6);
  EXPECT_NEAR(angle_to(o, {-c, 0, c}), 0, 1e-6);
  EXPECT_NEAR(angle_to(o, normalize(Vec3d{-2, 0, 1})), 0, 0.5);
  EXPECT_NEAR(angle_to(o, {0, 0, 1}), 45, 1e-6);
  EXPECT_NEAR(angle_to(o, {-c, 0, -c}), 45, 1e-6);
}

// A window of 1 x 1 with a cross of bars, 0.04 wide.
KnownAperture barred_window() {
  KnownAperture o = rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, 0.2);
  const auto pane = [](double y, double z) {
    return rectangle({0, y, z}, {0, 0.48, 0}, {0, 0, 0.48}, {-1, 0, 0}, 0.03);
  };
  o.panes = {pane(0, 0), pane(0, 0.52), pane(0.52, 0), pane(0.52, 0.52)};
  o.obstacles = box({-0.015, 0.48, 0}, {0.015, 0.52, 1});
  for (const Quad& q : box({-0.015, 0, 0.48}, {0.015, 1, 0.52})) o.obstacles.push_back(q);
  return o;
}

TEST(portal_score, takes_one_portal_or_one_for_each_pane) {
  const std::vector<KnownAperture> openings{barred_window()};
  const Portal whole = portal_of(openings[0]);
  std::vector<Portal> panes;
  for (const KnownAperture& pane : openings[0].panes) panes.push_back(portal_of(pane));
  EXPECT_TRUE(score({whole}, openings).right());
  EXPECT_TRUE(score(panes, openings).right());
  EXPECT_FALSE(score({whole, panes[0]}, openings).right());
  EXPECT_FALSE(score({whole, whole}, openings).right());
  EXPECT_FALSE(score({panes[0]}, openings).right());
  EXPECT_FALSE(score({panes[0], panes[1], panes[2]}, openings).right());
  EXPECT_FALSE(score({panes[0], panes[1], panes[2], panes[2]}, openings).right());
  const Portal half = portal_of(rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 0.48}, {-1, 0, 0}, 0));
  EXPECT_FALSE(score({half, panes[1], panes[3]}, openings).right());
}

TEST(portal_score, leaves_free_whether_what_obstacles_stop_is_covered) {
  KnownAperture o = rectangle({0, 0, 0}, {0, 2, 0}, {0, 0, 0.8}, {-1, 0, 0}, 0.1);
  const Portal whole = portal_of(o);
  const Portal above = portal_of(rectangle({0, 0.6, 0}, {0, 1.4, 0}, {0, 0, 0.8}, {-1, 0, 0}, 0));
  EXPECT_FALSE(score({above}, {o}).right());
  o.obstacles = box({-0.3, 0, 0}, {0.3, 0.62, 0.8});
  EXPECT_TRUE(score({above}, {o}).right());
  EXPECT_TRUE(score({whole}, {o}).right());
  const Portal higher = portal_of(rectangle({0, 0.8, 0}, {0, 1.2, 0}, {0, 0, 0.8}, {-1, 0, 0}, 0));
  EXPECT_FALSE(score({higher}, {o}).right());
}

TEST(portal_score, asks_for_no_portal_where_it_is_optional) {
  KnownAperture o = rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, 0.1);
  o.optional = true;
  const Portal good = portal_of(o);
  EXPECT_TRUE(score({}, {o}).right());
  EXPECT_TRUE(score({good}, {o}).right());
  EXPECT_FALSE(score({good, good}, {o}).right());
  Portal far = good;
  for (Vec3d& v : far.vertices) v.z += 3;
  EXPECT_FALSE(score({far}, {o}).right());
  EXPECT_FALSE(score({good, far}, {o}).right());
  // Half of it is worse than none.
  EXPECT_FALSE(
      score({portal_of(rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0))}, {o}).right());
  const KnownAperture door = rectangle({0, 0, 5}, {0, 2, 0}, {0, 0, 1}, {-1, 0, 0}, 0.1);
  EXPECT_FALSE(score({}, {door, o}).right());
  EXPECT_TRUE(score({portal_of(door)}, {door, o}).right());
  EXPECT_TRUE(score({portal_of(door), good}, {door, o}).right());
}

TEST(portal_score, sees_every_planted_fault) {
  const std::vector<KnownAperture> openings{
      rectangle({0, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0.1)};
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
  Portal backwards = good;
  for (auto& t : backwards.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(score({backwards}, openings).coverage, 0);
  Portal far = good;
  for (Vec3d& v : far.vertices) v.z += 3;
  EXPECT_EQ(score({good, far}, openings).strays, 1u);
  EXPECT_FALSE(score({good, good}, openings).right());
  EXPECT_FALSE(score({}, openings).right());
  EXPECT_EQ(score({good}, {}).strays, 1u);
}

// Number of pieces of furniture whose box contains a point in front of an opening, `before` its
// wall [metres].
int pieces_before_windows(double before) {
  int pieces = 0;
  for (const RoomKind kind : {RoomKind::sky_windows, RoomKind::corner_windows})
    for (uint64_t seed = 700; seed < 760; ++seed) {
      const KnownRoom room = known_room(kind, seed);
      for (const RoomPlan::Part& part : room.plan.parts) {
        const auto is = [&](const char* name) { return part.name == name; };
        if (!is("box") && !is("table") && !is("chair") && !is("shelf")) continue;
        Vec3d low(INFINITY), high(-INFINITY);
        for (const Quad& q : part.quads)
          for (const Vec3d& p : q) low = min(low, p), high = max(high, p);
        pieces +=
            std::any_of(room.apertures.begin(), room.apertures.end(), [&](const KnownAperture& o) {
              for (double u = 0.05; u < 1; u += 0.1)
                for (double v = 0.05; v < 1; v += 0.1) {
                  const Vec3d p = o.outline[0] + (o.outline[1] - o.outline[0]) * u +
                                  (o.outline[3] - o.outline[0]) * v +
                                  o.normal * (0.5 * o.thickness + before);
                  if (min(p, low) == low && max(p, high) == high) return true;
                }
              return false;
            });
      }
    }
  return pieces;
}

TEST(known_rooms, have_no_furniture_right_before_a_window) {
  for (const double before : {0.02, 0.15, 0.3, 0.55}) EXPECT_EQ(pieces_before_windows(before), 0);
  EXPECT_GT(pieces_before_windows(1), 10);  // twin: farther away there is some
}

TEST(portal_distance, is_that_of_shifted_squares) {
  const Portal a = portal_of(rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0));
  Portal b = a;
  for (Vec3d& v : b.vertices) v += Vec3d{0.3, 0, 0.4};
  EXPECT_NEAR(distance(a, a), 0, 1e-12);
  EXPECT_NEAR(distance(a, b), 0.5, 1e-12);
  b = portal_of(rectangle({0.2, 0.2, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 1}, 0));
  EXPECT_NEAR(distance(a, b), std::sqrt(2) * 0.7, 1e-12);  // from the far corner
  EXPECT_NEAR(distance_to_nearest(a, {b, a}), 0, 1e-12);
  EXPECT_TRUE(std::isinf(distance_to_nearest(a, {})));
}

}  // namespace tdpt::testing::known_rooms_test
