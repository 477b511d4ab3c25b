// Houses without lamps, lit through their windows by a sky, the sun or both.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libcommon/testing/rooms/known_kinds.h"

namespace tdpt::testing {
namespace {

constexpr double kGround = -0.1;  // height of the ground, below the floor

// Walls in the order of walls_of(): +x, +z, -x, -z, each with its windows.
struct House {
  Space room;
  double thickness;
  std::array<std::vector<WallOpening>, 4> windows;
};

std::vector<Wall> walls_of(const House& h) {
  const Space& r = h.room;
  const std::vector<Vec3d> round{{r.x0, 0, r.z0}, {r.x1, 0, r.z0}, {r.x1, 0, r.z1},
                                 {r.x0, 0, r.z1}, {r.x0, 0, r.z0}, {r.x1, 0, r.z0}};
  std::vector<Wall> walls =
      walls_along(round, h.thickness, r.y0, r.y1, kGround, r.y1 + h.thickness);
  walls.erase(walls.begin());
  // The last wall ends in a mitre that walls_along does not know of.
  walls.back().far.b = walls.front().far.a;
  walls.back().far.s1 = walls.back().near.s1 + h.thickness;
  return walls;
}

struct Level {
  double x0, x1, z0, z1;
};

// A horizontal face with rectangular holes; `up`: the front is above.
std::vector<Quad> level(const Level& l, double y, const std::vector<Level>& holes, bool up) {
  const Face face{{l.x0, 0, 0}, {l.x1, 0, 0}, l.x0, l.x1, l.z0, l.z1};
  std::vector<WallOpening> cuts;
  for (const Level& h : holes) cuts.push_back({h.z0, h.z1, h.x0, h.x1});
  std::vector<Quad> quads = pierced_face(face, cuts, !up);
  for (Quad& q : quads)
    for (Vec3d& p : q) p = {p.x, y, p.y};
  return quads;
}

// Walls, floor, ceiling and roof; the light enters through the windows and `skylights`.
void build(Site& site, const House& h, const std::vector<Level>& skylights = {}) {
  const Space& r = h.room;
  const double t = h.thickness, top = r.y1 + t;
  const Level inside{r.x0, r.x1, r.z0, r.z1}, outside{r.x0 - t, r.x1 + t, r.z0 - t, r.z1 + t};
  const std::vector<Wall> walls = walls_of(h);
  for (size_t k = 0; k < walls.size(); ++k) pierce(site, walls[k], h.windows[k]);
  site.part("floor", level(inside, r.y0, {}, true));
  site.part("ceiling", level(inside, r.y1, skylights, false));
  site.part("roof", level(outside, top, skylights, true));
  for (const Level& s : skylights) {
    const Vec3d c[] = {{s.x0, 0, s.z0}, {s.x1, 0, s.z0}, {s.x1, 0, s.z1}, {s.x0, 0, s.z1}};
    std::vector<Quad> lining;
    KnownAperture o{{}, {0, -1, 0}, t};
    for (size_t k = 0; k < 4; ++k) {
      const Vec3d &a = c[k], &b = c[(k + 1) % 4], low{0, r.y1, 0}, high{0, top, 0};
      lining.push_back({a + low, b + low, b + high, a + high});
      o.outline.push_back(a + Vec3d{0, r.y1 + 0.5 * t, 0});
    }
    site.part("lining", lining);
    site.opening(o);
  }
}

// Ground, sometimes a house opposite, and the sky or sun.
void outdoors(Site& site, const Space& room) {
  const char* const lights[] = {"sky", "sun", "both"};
  const std::string light = lights[site.count_between(0, 2)];
  const double reach = site.log_between(8, 60);
  const bool ground = site.chance(0.8) || light == "sun";
  if (ground)
    site.part("ground", level({room.x0 - reach, room.x1 + reach, room.z0 - reach, room.z1 + reach},
                              kGround, {}, true));
  const double away = site.between(3, 7), high = site.between(2, 6);
  if (ground && site.chance(0.3))
    site.part("house",
              box({room.x1 + away, kGround, room.z0 - 1}, {room.x1 + away + 1, high, room.z1 + 1}));
  const double up = site.between(20, 60) * kDegree, round = site.between(0, 360) * kDegree;
  const Vec3d sun{std::cos(up) * std::cos(round), std::sin(up), std::cos(up) * std::sin(round)};
  const double blue = site.between(0.6, 2);
  site.daylight(light, light == "sky" ? Vec3d{} : sun,
                light == "sun" ? Vec3d{} : Vec3d{0.8, 0.9, blue});
}

Space a_room(Site& site) {
  const double h = site.between(2.4, 2.9), l = site.between(2.8, 5), d = site.between(3, 5);
  return {0, l, 0, h, -0.5 * d, 0.5 * d};
}

// A random position in a wall, within `from` .. `to` along it, at least 0.2 m from the ends.
WallOpening window(Site& site, const Space& room, double from, double to) {
  const double wide = std::min(site.between(0.5, 1.4), to - from - 0.4);
  const double sill = site.between(0.3, 1), high = site.between(0.6, room.y1 - sill - 0.25);
  const double s = site.between(from + 0.2, to - 0.2 - wide);
  return {sill, sill + high, s, s + wide};
}

void furnish_and_look(Site& site, const Space& room) {
  furnish(site, room);
  site.camera(room);
}

}  // namespace

void sky_window(Site& site) {
  const double t = site.log_between(0.01, 0.4);
  House h{a_room(site), t, {}};
  h.windows[0] = {window(site, h.room, 0, h.room.depth())};
  build(site, h);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void sky_windows(Site& site) {
  const double t = site.log_between(0.01, 0.4);
  House h{a_room(site), t, {}};
  const int n = site.count_between(2, 5);
  const double lengths[] = {h.room.depth(), h.room.x1, h.room.depth()};
  // Each half of a wall holds at most one window, so that they stay apart.
  for (int k = 0, place = site.count_between(0, 5); k < n; ++k, place = (place + 1) % 6) {
    const auto wall = static_cast<size_t>(place / 2);
    const double half = 0.5 * lengths[wall], from = place % 2 * half;
    h.windows[wall].push_back(window(site, h.room, from, from + half));
  }
  build(site, h);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void corner_windows(Site& site) {
  const double t = site.log_between(0.05, 0.3);
  House h{a_room(site), t, {}};
  const double sill = site.between(0.4, 0.9), high = site.between(0.8, 1.3);
  const double end = h.room.depth() - site.between(0.03, 0.1), wide = site.between(0.6, 1.4);
  const double start = site.between(0.03, 0.1), other = site.between(0.6, 1.4);
  h.windows[0] = {{sill, sill + high, end - wide, end}};
  h.windows[1] = {{sill, sill + high, start, start + other}};
  build(site, h);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void skylight(Site& site) {
  const double t = site.log_between(0.05, 0.4);
  const House h{a_room(site), t, {}};
  std::vector<Level> lights;
  const int n = site.count_between(1, 2);
  for (int k = 0; k < n; ++k) {
    const double half = h.room.x1 / n, wide = std::min(site.between(0.5, 1.2), half - 0.6);
    const double deep = site.between(0.5, 1.2);
    const double x = k * half + site.between(0.3, half - 0.3 - wide);
    const double z = site.between(h.room.z0 + 0.3, h.room.z1 - 0.3 - deep);
    lights.push_back({x, x + wide, z, z + deep});
  }
  build(site, h, lights);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void sky_blinds(Site& site) {
  const double t = site.log_between(0.05, 0.4);
  House h{a_room(site), t, {}};
  const WallOpening o = window(site, h.room, 0, h.room.depth());
  h.windows[0] = {o};
  const int n = site.count_between(8, 24);
  const double wide = (o.y1 - o.y0) / n * site.between(0.7, 1);
  const double steep = site.between(10, 45) * kDegree, tilt = site.chance(0.5) ? steep : -steep;
  const double off = 0.5 * wide * std::cos(tilt) + site.between(0.01, 0.03);
  const Wall wall = walls_of(h)[0];
  const bool inside = site.chance(0.5);
  const std::vector<Quad> all =
      slats(wall, o, n, wide, tilt, inside ? h.room.x1 - off : h.room.x1 + t + off, 0.02);
  // Half shut: only the upper slats are let down.
  const auto down = static_cast<std::ptrdiff_t>(site.count_between(n / 3, n / 2));
  const std::vector<Quad> shut{all.end() - down, all.end()};
  build(site, h);
  site.obstacles_of_last(shut);
  site.part("slats", shut);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void colonnade(Site& site) {
  const double h = site.between(2.8, 3.5), l = site.between(4, 7), d = site.between(6, 9);
  const double t = site.between(0.3, 0.5);
  House hall{{0, l, 0, h, -0.5 * d, 0.5 * d}, t, {}};
  const int n = site.count_between(3, 5);
  const double wide = std::min(site.between(0.6, 1.1), d / n - 0.4);
  const double high = site.between(1.9, h - 0.4);
  for (int k = 0; k < n; ++k) {
    const double s = d * (k + 0.5) / n;
    hall.windows[0].push_back({0, high, s - 0.5 * wide, s + 0.5 * wide});
  }
  build(site, hall);
  outdoors(site, hall.room);
  furnish_and_look(site, hall.room);
}

void room_behind(Site& site) {
  const double t = site.log_between(0.02, 0.3), wall = site.log_between(0.02, 0.25);
  const Space first = a_room(site);
  Space second = first;
  second.x0 = first.x1 + wall, second.x1 = second.x0 + site.between(2.5, 4);
  House h{first, t, {}};
  h.room.x1 = second.x1;
  const int n = site.count_between(1, 2);
  const double half = h.room.depth() / n;
  for (int k = 0; k < n; ++k)
    h.windows[0].push_back(window(site, second, k * half, (k + 1) * half));
  build(site, h);
  const Wall between = wall_between(first, second);
  const double wide = site.between(0.7, 0.9), high = site.between(1.9, 2.1);
  const double s = site.between(0.3, first.depth() - 0.3 - wide);
  const WallOpening door{0, high, s, s + wide};
  site.part("partition", pierced(between, {door}));
  site.opening(aperture(between, door));
  outdoors(site, h.room);
  furnish(site, second);
  furnish_and_look(site, first);
}

void deep_facade(Site& site) {
  const double t = site.between(0.3, 0.6);
  House h{a_room(site), t, {}};
  const int n = site.count_between(1, 2);
  const double half = h.room.depth() / n;
  for (int k = 0; k < n; ++k)
    h.windows[0].push_back(window(site, h.room, k * half, (k + 1) * half));
  build(site, h);
  // A balcony above, and posts that support it.
  const double x = h.room.x1 + t, deep = site.between(0.6, 1.6), top = h.room.y1 + 0.05;
  site.part("balcony", box({x, top, h.room.z0}, {x + deep, top + 0.15, h.room.z1}));
  for (const double z : {h.room.z0 + 0.05, h.room.z1 - 0.2})
    site.part("post", box({x + deep - 0.2, kGround, z}, {x + deep - 0.05, top, z + 0.15}));
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

void landscape(Site& site) {
  const Space place{0, 6, 0, 3, -3, 3};
  site.part("ground", level({-30, 30, -30, 30}, 0, {}, true));
  site.furniture(place);
  const double x = site.between(3, 5), z = site.between(-2, 1);
  site.part("house", box({x, 0, z}, {x + 3, 3, z + 2}));
  const char* const lights[] = {"sky", "sun", "both"};
  const std::string light = lights[site.count_between(0, 2)];
  site.daylight(light, light == "sky" ? Vec3d{} : normalize(Vec3d{0.5, 0.7, 0.4}),
                light == "sun" ? Vec3d{} : Vec3d{1, 1, 1});
  site.camera(place);
}

void deep_room(Site& site) {
  const double high = site.between(2.4, 2.9), wide = site.between(3, 4.2);
  const double deep = wide * site.between(2, 2.5), t = site.between(0.1, 0.3);
  House h{{0, deep, 0, high, -0.5 * wide, 0.5 * wide}, t, {}};
  h.windows[0] = {{0, high, 0, wide}};
  build(site, h);
  outdoors(site, h.room);
  furnish_and_look(site, h.room);
}

}  // namespace tdpt::testing
