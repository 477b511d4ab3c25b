// Light walks through the generated rooms: the known openings, and nothing else, connect the
// camera's side to that of the lamps or the sky.
#include <algorithm>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing::known_sides_test {

// Rays and diffuse walks in a plan, in its own coordinates.
class TracedPlan {
 public:
  /// `open`: light comes from the sky or the sun, where a ray hits nothing.
  TracedPlan(const RoomPlan& plan, bool open)
      : scene_(read_gltf(TempFolder().write("room.glb", plan.glb()))),
        tracer_(scene_),
        open_(open) {}

  bool sees(const Vec3d& a, const Vec3d& b) const {
    return tracer_.visible({scene_.frame.to_canonical(a)}, {scene_.frame.to_canonical(b)});
  }

  /// Whether a walk that starts this way hits a lamp's front or leaves to the sky within 60
  /// bounces.
  bool finds_light(const Line& start, Rng& rng) const {
    Tracer::Origin from{scene_.frame.to_canonical(start.point)};
    Vec3d w = start.direction;
    for (int bounce = 0; bounce < 60; ++bounce) {
      Hit hit;
      if (!tracer_.closest(from, w, hit)) return open_ && hit.triangle == ~0u;
      const bool front = dot(hit.normal, w) < 0;
      const Material& material = scene_.material_of(hit.triangle);
      if (max_component(material.emission) > 0) return front;
      const Vec3d n = front ? hit.normal : -hit.normal;
      const double a = rng.uniform(), b = rng.uniform();
      w = Onb<double>(n).to_world(cosine_hemisphere(a, b));
      from = {hit.position, n};
    }
    return false;
  }

 private:
  Scene scene_;
  Tracer tracer_;
  bool open_;
};

bool under_a_sky(RoomKind kind) {
  const std::vector<RoomKind>& kinds = sky_room_kinds();
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

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

TracedPlan traced(const KnownRoom& room, const std::vector<KnownAperture>& filled = {}) {
  RoomPlan plan = room.plan;
  for (const KnownAperture& o : filled) plan.parts.push_back(filling(o));
  return {plan, under_a_sky(room.kind)};
}

std::vector<KnownAperture> all_but(const KnownRoom& room, size_t but) {
  std::vector<KnownAperture> others = room.apertures;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(but));
  return others;
}

Vec3d any_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1, t = 6.283185307179586 * rng.uniform();
  return {std::sqrt(1 - z * z) * std::cos(t), std::sqrt(1 - z * z) * std::sin(t), z};
}

// Number of walks from the camera that find light.
int lights_found(const KnownRoom& room, const std::vector<KnownAperture>& filled, int walks) {
  const TracedPlan plan = traced(room, filled);
  int found = 0;
  for (int k = 0; k < walks; ++k) {
    Rng rng(6, 0, static_cast<uint64_t>(k));
    const Vec3d w = any_direction(rng);
    found += plan.finds_light({room.plan.camera, w}, rng);
  }
  return found;
}

std::vector<RoomKind> kinds_with_openings() {
  std::vector<RoomKind> kinds = all_room_kinds();
  // One kind has no opening, and hardly any walk passes a keyhole.
  std::erase(kinds, RoomKind::open_room);
  std::erase(kinds, RoomKind::keyhole);
  for (const RoomKind kind : sky_room_kinds())
    if (kind != RoomKind::landscape) kinds.push_back(kind);
  return kinds;
}

constexpr uint64_t kSeeds[] = {7, 8};

TEST(known_sides, are_joined_by_the_known_openings_and_by_nothing_else) {
  for (const RoomKind kind : kinds_with_openings())
    for (const uint64_t seed : kSeeds) {
      const KnownRoom room = known_room(kind, seed);
      EXPECT_EQ(lights_found(room, room.apertures, 3000), 0) << room.file();
      // Too few walks find a hole.
      if (kind == RoomKind::hole || kind == RoomKind::holes_in_row) continue;
      EXPECT_GT(lights_found(room, {}, 3000), 0) << room.file();
    }
}

TEST(known_sides, twin_one_opening_left_open_is_noticed) {
  for (const RoomKind kind :
       {RoomKind::two_openings, RoomKind::bay, RoomKind::windows_in_row, RoomKind::shared_edge,
        RoomKind::sky_windows, RoomKind::corner_windows, RoomKind::skylight, RoomKind::colonnade,
        RoomKind::deep_facade}) {
    uint64_t seed = 1;
    while (known_room(kind, seed).apertures.size() < 2) ++seed;
    const KnownRoom room = known_room(kind, seed);
    for (size_t i = 0; i < room.apertures.size(); ++i)
      EXPECT_GT(lights_found(room, all_but(room, i), 3000), 0) << room.file() << " " << i;
  }
}

// The last opening is the door between the rooms: closing it alone keeps the camera's room dark,
// and so does closing only the windows.
TEST(known_sides, of_a_room_behind_another_are_joined_through_both_walls) {
  for (const uint64_t seed : kSeeds) {
    const KnownRoom room = known_room(RoomKind::room_behind, seed);
    const size_t door = room.apertures.size() - 1;
    EXPECT_EQ(lights_found(room, {room.apertures[door]}, 3000), 0) << room.file();
    EXPECT_EQ(lights_found(room, all_but(room, door), 3000), 0) << room.file();
  }
}

TEST(known_sides, a_landscape_is_in_the_open) {
  const KnownRoom place = known_room(RoomKind::landscape, 7);
  EXPECT_TRUE(place.apertures.empty());
  EXPECT_GT(lights_found(place, {}, 3000), 2900);
}

// Walks from the filled opening, to the side that its light goes to (1) or comes from (-1).
int lights_found_from(const KnownAperture& o, const TracedPlan& plan, double side) {
  constexpr double kOff = 1e-3;
  int found = 0;
  Rng rng(8, 0, 0);
  for (const Line& line : free_lines(o, 500)) {
    const Vec3d w = line.direction * side;
    found += plan.finds_light({line.point + w * kOff, w}, rng);
  }
  return found;
}

TEST(known_sides, have_the_light_behind_the_opening_and_none_before_it) {
  for (const RoomKind kind : kinds_with_openings()) {
    const KnownRoom room = known_room(kind, 7);
    const TracedPlan plan = traced(room, room.apertures);
    int behind = 0;
    for (const KnownAperture& o : room.apertures) {
      EXPECT_EQ(lights_found_from(o, plan, 1), 0) << room.file();
      behind += lights_found_from(o, plan, -1);
    }
    EXPECT_GT(behind, 0) << room.file();
  }
}

// Share of the lines through a room's openings that the scene blocks in or near the wall: within 6
// cm where slats or curtains hang, which lets a few hit the floor.
double share_stopped(const KnownRoom& room, const std::vector<KnownAperture>& openings,
                     double beyond) {
  const TracedPlan plan = traced(room);
  int lines = 0, stopped = 0;
  for (const KnownAperture& o : openings)
    for (const Line& line : free_lines(o, 2000)) {
      const double reach = (0.5 * o.thickness + beyond) / dot(line.direction, o.normal);
      if (reach > 1) continue;  // so oblique that it hits furniture and corners
      ++lines;
      stopped +=
          !plan.sees(line.point - line.direction * reach, line.point + line.direction * reach);
    }
  return lines > 0 ? static_cast<double>(stopped) / lines : 1;
}

TEST(known_sides, see_each_other_along_the_free_lines) {
  for (const RoomKind kind : kinds_with_openings()) {
    // Beside a leaf the lines continue along it.
    if (kind == RoomKind::ajar || kind == RoomKind::ajar_full) continue;
    for (const uint64_t seed : kSeeds) {
      const KnownRoom room = known_room(kind, seed);
      const bool plain = room.apertures[0].obstacles.empty() && room.apertures[0].mouth.empty();
      EXPECT_LT(share_stopped(room, room.apertures, plain ? 0.002 : 0.06), plain ? 0.02 : 0.05)
          << room.file();
    }
  }
}

TEST(known_sides, twin_slats_bars_and_furniture_that_are_kept_quiet_are_noticed) {
  for (const RoomKind kind : {RoomKind::glazing_bars, RoomKind::blinds, RoomKind::furnished_door,
                              RoomKind::curtains, RoomKind::sky_blinds}) {
    const KnownRoom room = known_room(kind, 7);
    std::vector<KnownAperture> bare = room.apertures;
    for (KnownAperture& o : bare) o.obstacles.clear(), o.mouth.clear();
    EXPECT_GT(share_stopped(room, bare, 0.06), 0.1) << room.file();
  }
}

}  // namespace tdpt::testing::known_sides_test
