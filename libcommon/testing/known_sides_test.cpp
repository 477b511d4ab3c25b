// Walks of light through the generated rooms: the known openings join the camera's side and the
// lamps' side, and nothing else does.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/testing/known_rooms.h"
#include "libcommon/testing/portal_score.h"
#include "libcommon/testing/temp_folder.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing {
namespace {

// Rays and diffuse walks in a plan, in its own frame.
class TracedPlan {
 public:
  explicit TracedPlan(const RoomPlan& plan)
      : scene_(read_gltf(TempFolder().write("room.glb", plan.glb()))), tracer_(scene_) {}

  bool sees(const Vec3d& a, const Vec3d& b) const {
    return tracer_.visible({scene_.frame.to_canonical(a)}, {scene_.frame.to_canonical(b)});
  }

  /// Whether a walk that starts this way meets a lamp's front within 60 bounces.
  bool finds_lamp(const Line& start, Rng& rng) const {
    Tracer::Origin from{scene_.frame.to_canonical(start.point)};
    Vec3d w = start.direction;
    for (int bounce = 0; bounce < 60; ++bounce) {
      Hit hit;
      if (!tracer_.closest(from, w, hit)) return false;
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
};

// A fan of quads over the outline, a little larger, so that its rim lies in the wall.
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

RoomPlan filled(const KnownRoom& room, size_t but = SIZE_MAX) {
  RoomPlan plan = room.plan;
  for (size_t i = 0; i < room.apertures.size(); ++i)
    if (i != but) plan.parts.push_back(filling(room.apertures[i]));
  return plan;
}

Vec3d any_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1, t = 6.283185307179586 * rng.uniform();
  return {std::sqrt(1 - z * z) * std::cos(t), std::sqrt(1 - z * z) * std::sin(t), z};
}

// Of walks from the camera.
int lamps_found(const RoomPlan& plan, int walks) {
  const TracedPlan traced(plan);
  int found = 0;
  for (int k = 0; k < walks; ++k) {
    Rng rng(6, 0, static_cast<uint64_t>(k));
    const Vec3d w = any_direction(rng);
    found += traced.finds_lamp({plan.camera, w}, rng);
  }
  return found;
}

std::vector<RoomKind> kinds_with_openings() {
  std::vector<RoomKind> kinds = all_room_kinds();
  // In one there is none, and through a keyhole hardly a walk finds its way.
  std::erase(kinds, RoomKind::open_room);
  std::erase(kinds, RoomKind::keyhole);
  return kinds;
}

constexpr uint64_t kSeeds[] = {7, 8};

TEST(known_sides, are_joined_by_the_known_openings_and_by_nothing_else) {
  for (const RoomKind kind : kinds_with_openings())
    for (const uint64_t seed : kSeeds) {
      const KnownRoom room = known_room(kind, seed);
      EXPECT_EQ(lamps_found(filled(room), 3000), 0) << room.file();
      // Too few find a hole by chance.
      if (kind == RoomKind::hole || kind == RoomKind::holes_in_row) continue;
      EXPECT_GT(lamps_found(room.plan, 3000), 0) << room.file();
    }
}

TEST(known_sides, twin_one_opening_left_open_is_noticed) {
  for (const RoomKind kind :
       {RoomKind::two_openings, RoomKind::bay, RoomKind::windows_in_row, RoomKind::shared_edge}) {
    uint64_t seed = 1;
    while (known_room(kind, seed).apertures.size() < 2) ++seed;
    const KnownRoom room = known_room(kind, seed);
    for (size_t i = 0; i < room.apertures.size(); ++i)
      EXPECT_GT(lamps_found(filled(room, i), 3000), 0) << room.file() << " " << i;
  }
}

// Walks off the filled opening, to the side that its light goes to (1) or comes from (-1).
int lamps_found_from(const KnownAperture& o, const TracedPlan& traced, double side) {
  constexpr double kOff = 1e-3;
  int found = 0;
  Rng rng(8, 0, 0);
  for (const Line& line : free_lines(o, 500)) {
    const Vec3d w = line.direction * side;
    found += traced.finds_lamp({line.point + w * kOff, w}, rng);
  }
  return found;
}

TEST(known_sides, have_the_lamp_behind_the_opening_and_none_before_it) {
  for (const RoomKind kind : kinds_with_openings()) {
    const KnownRoom room = known_room(kind, 7);
    const TracedPlan traced(filled(room));
    int behind = 0;
    for (const KnownAperture& o : room.apertures) {
      EXPECT_EQ(lamps_found_from(o, traced, 1), 0) << room.file();
      behind += lamps_found_from(o, traced, -1);
    }
    EXPECT_GT(behind, 0) << room.file();
  }
}

// Of the lines through the openings of a room, the share that the scene stops in the wall or near
// it: within 6 cm where slats or curtains hang, which lets a few meet the floor.
double share_stopped(const KnownRoom& room, const std::vector<KnownAperture>& openings,
                     double beyond) {
  const TracedPlan traced(room.plan);
  int lines = 0, stopped = 0;
  for (const KnownAperture& o : openings)
    for (const Line& line : free_lines(o, 2000)) {
      const double reach = (0.5 * o.thickness + beyond) / dot(line.direction, o.normal);
      if (reach > 1) continue;  // so slanting that it meets furniture and corners
      ++lines;
      stopped +=
          !traced.sees(line.point - line.direction * reach, line.point + line.direction * reach);
    }
  return lines > 0 ? static_cast<double>(stopped) / lines : 1;
}

TEST(known_sides, see_each_other_along_the_free_lines) {
  for (const RoomKind kind : kinds_with_openings()) {
    // Beside a leaf the lines go on along it.
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
  for (const RoomKind kind :
       {RoomKind::glazing_bars, RoomKind::blinds, RoomKind::furnished_door, RoomKind::curtains}) {
    const KnownRoom room = known_room(kind, 7);
    std::vector<KnownAperture> bare = room.apertures;
    for (KnownAperture& o : bare) o.obstacles.clear(), o.mouth.clear();
    EXPECT_GT(share_stopped(room, bare, 0.06), 0.1) << room.file();
  }
}

}  // namespace
}  // namespace tdpt::testing
