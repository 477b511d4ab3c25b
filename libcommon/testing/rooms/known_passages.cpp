// Rooms connected by passages: arches, stairwells, doors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/testing/rooms/known_kinds.h"

namespace tdpt::testing {
namespace {

// A row of the camera's space, a wall, and the lamps' space.
struct Pair {
  Space near, far;
  Wall wall = wall_between(near, far);
};

// Two rooms of equal height and depth, so long.
Pair alike(double height, double depth, double wall, double near, double far) {
  const double z = 0.5 * depth;
  return {{0, near, 0, height, -z, z}, {near + wall, near + wall + far, 0, height, -z, z}};
}

Pair rooms_for_a_door(Site& site, double low, double high) {
  const double h = site.between(2.4, 2.8), d = site.between(std::max(low, 2.4), high);
  const double t = site.log_between(0.01, 0.3);
  const double a = site.between(low, high), b = site.between(low, high);
  return alike(h, d, t, a, b);
}

void shells(Site& site, const Pair& rooms) {
  site.part("shell", shell(rooms.near, kX1));
  site.part("shell", shell(rooms.far, kX0));
}

void furnish_and_look(Site& site, const Pair& rooms) {
  site.lamps(rooms.far);
  furnish(site, rooms.near);
  furnish(site, rooms.far);
  site.camera(rooms.near);
}

// `aside`: distance from the walls along x.
WallOpening door(Site& site, const Wall& wall, double width, double height, double aside = 0.1) {
  const double s = site.between(aside, wall.near.s1 - aside - width);
  return {0, height, s, s + width};
}

// A door leaf on one face of the wall, hinged at s, that would reach to s + width (which may be
// negative) if closed; opened by `angle` away from the wall.
std::vector<Quad> open_leaf(const Wall& wall, bool to_near, double s, double width, double height,
                            double angle) {
  constexpr double kThick = 0.04, kClear = 0.005;
  const Vec3d hinge = wall.at(s, 0, to_near ? 0 : wall.thickness);
  const double out = to_near ? -1 : 1;
  const Vec3d low{to_near ? hinge.x - kThick : hinge.x, kClear, hinge.z + std::min(0.0, width)};
  const Vec3d high{to_near ? hinge.x : hinge.x + kThick, height - kClear,
                   hinge.z + std::max(0.0, width)};
  return box(low, high, (width > 0 ? out : -out) * angle, hinge);
}

// A few steps, along the last wall.
void steps(Site& site, const Space& s) {
  constexpr double kRise = 0.17, kGoing = 0.27;
  const int n = site.count_between(3, 5);
  const double wide = site.between(0.8, 1.1);
  for (int k = 0; k < n; ++k) {
    const double z = s.z0 + (n - 1 - k) * kGoing;
    site.part("step", box({s.x1 - wide, s.y0, z}, {s.x1, s.y0 + (k + 1) * kRise, z + kGoing}));
  }
}

// The random area and width, limited to what fits into the walls of both spaces.
RoundArch arch_into(Site& site, const Pair& rooms) {
  const double high = std::min(rooms.near.y1, rooms.far.y1);
  const double z0 = std::max(rooms.near.z0, rooms.far.z0),
               z1 = std::min(rooms.near.z1, rooms.far.z1);
  for (;;) {
    const double area = site.log_between(3, 9), w = site.between(1.5, 3);
    const double springing = area / w - std::numbers::pi * w / 8;
    const double z = site.between(z0 + 0.15, z1 - 0.15 - w);
    const int segments = site.count_between(10, 24);
    const RoundArch arch{z - rooms.near.z0, z - rooms.near.z0 + w, 0, springing, segments};
    if (w < z1 - z0 - 0.3 && springing > 0.5 && arch.top() < high - 0.2 &&
        area < 0.45 * high * (z1 - z0))
      return arch;
  }
}

// Balusters from the floor to a rail, in the middle of the wall.
std::vector<Quad> balustrade(Site& site, const Wall& wall, const WallOpening& o) {
  const double wide = site.between(0.02, 0.04), high = site.between(0.85, 1);
  const int n = static_cast<int>((o.z1 - o.z0) / site.between(0.1, 0.14));
  const auto bar = [&](double s0, double s1, double y0, double y1, double deep) {
    return box(wall.at(s0, y0, 0.5 * (wall.thickness - deep)),
               wall.at(s1, y1, 0.5 * (wall.thickness + deep)));
  };
  std::vector<Quad> quads = bar(o.z0, o.z1, high, high + 0.05, 0.05);
  for (int k = 0; k < n; ++k) {
    const double s = o.z0 + (o.z1 - o.z0) * (k + 0.5) / n;
    append(quads, bar(s - 0.5 * wide, s + 0.5 * wide, o.y0, high, wide));
  }
  return quads;
}

// A closed leaf in its half of the doorway, in the middle of the wall and slightly into it.
std::vector<Quad> shut_leaf(const Wall& wall, const WallOpening& half, double thick) {
  constexpr double kInto = 0.005;
  return box(wall.at(half.z0 - kInto, -kInto, 0.5 * (wall.thickness - thick)),
             wall.at(half.z1, half.y1 + kInto, 0.5 * (wall.thickness + thick)));
}

// Door and window of equal width with a bar between: one opening, or two.
void barred_transom(Site& site, const Wall& wall, const WallOpening& door, double window) {
  const double bar = site.between(0.03, 0.08), deep = site.between(0.03, 0.06);
  const WallOpening over{door.y1 + bar, door.y1 + bar + window, door.z0, door.z1};
  const WallOpening both{0, over.y1, door.z0, door.z1};
  site.part("wall", pierced(wall, {both}));
  const std::vector<Quad> quads = box(wall.at(door.z0, door.y1, 0.5 * (wall.thickness - deep)),
                                      wall.at(door.z1, over.y0, 0.5 * (wall.thickness + deep)));
  site.part("transom", quads);
  KnownAperture o = aperture(wall, both);
  o.obstacles = quads;
  for (const WallOpening& part : {door, over}) {
    KnownAperture pane = aperture(wall, part);
    pane.thickness = deep;
    o.panes.push_back(pane);
  }
  site.opening(o);
}

// A window wider than the door, down to the door's top: together they are no rectangle.
void wide_transom(Site& site, const Wall& wall, const WallOpening& door, double window) {
  const double left = site.between(0.3, 0.6), right = site.between(0.3, 0.6);
  const WallOpening over{door.y1, door.y1 + window, door.z0 - left, door.z1 + right};
  const std::vector<Vec3d> corners{
      {door.z0, 0, 0},       {door.z1, 0, 0},       {door.z1, door.y1, 0}, {over.z1, over.y0, 0},
      {over.z1, over.y1, 0}, {over.z0, over.y1, 0}, {over.z0, over.y0, 0}, {door.z0, door.y1, 0}};
  site.part("wall", pierced_as_one(wall, {door, over}, corners));
  for (const WallOpening& part : {door, over}) {
    KnownAperture o = aperture(wall, part);
    // In a thick wall, light may enter through one and leave through the other.
    o.thickness = 0;
    o.obstacles = lining(wall, corners);
    site.opening(o);
  }
}

// The mouth of a box is its open side, in the direction of the light out of it.
KnownAperture mouth_of(const Space& s, Side open) {
  KnownAperture o;
  o.optional = true;
  if (open == kX0) {
    o.outline = {{s.x0, s.y0, s.z0}, {s.x0, s.y0, s.z1}, {s.x0, s.y1, s.z1}, {s.x0, s.y1, s.z0}};
    o.normal = {-1, 0, 0};
  } else {
    const double y = open == kFloor ? s.y0 : s.y1;
    o.outline = {{s.x0, y, s.z0}, {s.x1, y, s.z0}, {s.x1, y, s.z1}, {s.x0, y, s.z1}};
    o.normal = {0, open == kFloor ? -1.0 : 1.0, 0};
  }
  return o;
}

// A lamp near one end of a box along the axis of its mouth, facing the mouth or away from it.
Quad lamp_in(Site& site, const Space& s, Side mouth) {
  const double size = std::min({s.x1 - s.x0, s.height(), s.depth()});
  const double r = size * site.between(0.15, 0.35), end = site.between(0.1, 0.3);
  const bool outwards = site.chance(0.6);
  const Vec3d middle{0.5 * (s.x0 + s.x1), 0.5 * (s.y0 + s.y1), s.middle_z()};
  const KnownAperture hole = mouth_of(s, mouth);
  // Distance of the lamp from the mouth, perpendicular to it.
  const double deep = mouth == kX0 ? s.x1 - s.x0 : s.height();
  const Vec3d n = hole.normal, at = middle + n * (deep * (0.5 - (outwards ? 1 - end : end)));
  const Vec3d u = mouth == kX0 ? Vec3d{0, r, 0} : Vec3d{r, 0, 0};
  const Vec3d v = cross(outwards ? n : -n, u);
  return {at - u - v, at + u - v, at + u + v, at - u + v};
}

}  // namespace

void arch(Site& site) {
  const double t = site.log_between(0.05, 0.4);
  const auto space = [&](double x0) -> Space {
    const double l = site.between(3, 8), h = site.between(3, 5.5), d = site.between(3, 8);
    return {x0, x0 + l, 0, h, -0.5 * d, 0.5 * d};
  };
  const Space near = space(0);
  const Pair rooms{near, space(near.x1 + t)};
  shells(site, rooms);
  const RoundArch arch = arch_into(site, rooms);
  site.part("wall", pierced(rooms.wall, arch));
  site.opening(aperture(rooms.wall, arch));
  steps(site, rooms.far);
  furnish_and_look(site, rooms);
}

void banister(Site& site) {
  const double h = site.between(2.3, 2.8), d = site.between(3, 6), t = site.log_between(0.05, 0.25);
  const double drop = site.between(0.3, 2.6), a = site.between(3, 5), b = site.between(3, 5);
  const bool camera_below = site.chance(0.5);
  Pair rooms = alike(h, d, t, a, b);
  (camera_below ? rooms.near : rooms.far).y0 = -drop;
  rooms.wall = wall_between(rooms.near, rooms.far);
  shells(site, rooms);
  const bool parapet = site.chance(0.5);
  const double w = site.between(1.2, std::min(2.5, d - 0.6));
  WallOpening open = door(site, rooms.wall, w, h, 0.2);
  if (parapet) open.y0 = site.between(0.85, 1.1);
  site.part("wall", pierced(rooms.wall, {open}));
  KnownAperture o = aperture(rooms.wall, open);
  if (!parapet) {
    o.obstacles = balustrade(site, rooms.wall, open);
    site.part("balustrade", o.obstacles);
  }
  site.opening(o);
  if (!camera_below) steps(site, rooms.far);
  furnish_and_look(site, rooms);
}

void double_door(Site& site) {
  const double h = site.between(2.5, 3), d = site.between(3.6, 5), t = site.log_between(0.05, 0.3);
  const double a = site.between(3, 5), b = site.between(3, 5);
  const Pair rooms = alike(h, d, t, a, b);
  shells(site, rooms);
  const double width = site.between(1.2, 1.8), high = site.between(2, 2.3);
  const WallOpening whole = door(site, rooms.wall, width, high, 0.8);
  site.part("wall", pierced(rooms.wall, {whole}));
  const bool one_shut = site.chance(0.5), to_near = site.chance(0.5);
  const double first = site.between(75, 130) * kDegree, second = site.between(75, 130) * kDegree;
  std::vector<Quad> leaves = open_leaf(rooms.wall, to_near, whole.z1, -0.5 * width, high, first);
  WallOpening open = whole;
  if (one_shut) {
    constexpr double kThick = 0.04;
    open.z0 += 0.5 * width;
    append(leaves, shut_leaf(rooms.wall, {0, high, whole.z0, open.z0}, kThick));
  } else {
    append(leaves, open_leaf(rooms.wall, to_near, whole.z0, 0.5 * width, high, second));
  }
  site.part("leaves", leaves);
  KnownAperture o = aperture(rooms.wall, open);
  o.obstacles = leaves;
  if (one_shut) {
    // As deep as the leaf; before and behind it the doorway is wider.
    o.thickness = 0.04;
    append(o.obstacles, lining(rooms.wall, whole));
  }
  site.opening(o);
  furnish_and_look(site, rooms);
}

void furnished_door(Site& site) {
  const Pair rooms = rooms_for_a_door(site, 2, 4);
  shells(site, rooms);
  const double width = site.between(0.8, 1.2), high = site.between(1.9, 2.1);
  const WallOpening open = door(site, rooms.wall, width, high);
  site.part("wall", pierced(rooms.wall, {open}));
  const double w = width * site.between(0.3, 0.6), h = site.between(0.4, 1.2);
  const double deep = site.between(0.3, 0.6), s = site.between(open.z0, open.z1 - w);
  const Vec3d foot = rooms.wall.at(s, 0, 0.5 * (rooms.wall.thickness - deep));
  KnownAperture o = aperture(rooms.wall, open);
  o.obstacles = box(foot, foot + Vec3d{deep, h, w});
  site.part("box", o.obstacles);
  site.opening(o);
  furnish_and_look(site, rooms);
}

void l_room(Site& site) {
  const double h = site.between(2.4, 2.8), d = site.between(3.5, 5),
               t = site.log_between(0.01, 0.3);
  const double a = site.between(2, 4), first = site.between(1.5, 2.5),
               second = site.between(1.5, 3);
  const double wide = site.between(1.4, 2.2);
  const Space near{0, a, 0, h, -0.5 * d, 0.5 * d};
  const Space far{a + t, a + t + first, 0, h, -0.5 * d, 0.5 * d};
  const Space arm{far.x1, far.x1 + second, 0, h, 0.5 * d - wide, 0.5 * d};
  const Pair rooms{near, far};
  site.part("shell", shell(near, kX1));
  site.part("shell", shell(far, kX0 | kX1));
  site.part("shell", shell(arm, kX0));
  Face beside{{far.x1, 0, far.z0}, {far.x1, 0, arm.z0}, 0, d - wide, 0, h};
  site.part("shell", pierced_face(beside, {}, true));
  const double width = site.between(0.6, 0.9), high = site.between(1.8, 2);
  const WallOpening open = door(site, rooms.wall, width, high);
  pierce(site, rooms.wall, {open});
  site.lamps(site.chance(0.5) ? far : arm);
  furnish(site, near);
  furnish(site, far);
  site.camera(near);
}

void alcove(Site& site) {
  const Pair rooms = rooms_for_a_door(site, 2, 4);
  const Space& far = rooms.far;
  site.part("shell", shell(rooms.near, kX1));
  site.part("shell", shell(far, kX0 | kX1));
  const double width = site.between(0.6, 0.9), high = site.between(1.8, 2);
  const WallOpening open = door(site, rooms.wall, width, high);
  pierce(site, rooms.wall, {open});

  const double w = site.between(0.6, 1.2), h = site.between(0.6, 1.4),
               deep = site.between(0.4, 0.9);
  const double y = site.between(0, 0.9), z = site.between(far.z0 + 0.1, far.z1 - 0.1 - w);
  const Space niche{far.x1, far.x1 + deep, y, y + h, z, z + w};
  const Face back{{far.x1, 0, far.z0}, {far.x1, 0, far.z1}, 0, far.depth(), 0, far.y1};
  site.part("shell", pierced_face(back, {{y, y + h, z - far.z0, z - far.z0 + w}}, true));
  site.part("alcove", shell(niche, kX0));
  site.opening(mouth_of(niche, kX0));
  const Quad quad = lamp_in(site, niche, kX0);
  site.lamp("alcove", quad, 20);
  furnish(site, rooms.near);
  furnish(site, far);
  site.camera(rooms.near);
}

void shared_edge(Site& site) {
  const double h = site.between(2.7, 3.2), d = site.between(3, 4), t = site.log_between(0.01, 0.2);
  const double a = site.between(2.5, 4), b = site.between(2.5, 4);
  const Pair rooms = alike(h, d, t, a, b);
  shells(site, rooms);
  const double width = site.between(0.7, 0.9), high = site.between(1.8, 2);
  const WallOpening open = door(site, rooms.wall, width, high, 0.7);
  const double window = site.between(0.3, 0.5);
  if (site.chance(0.5))
    barred_transom(site, rooms.wall, open, window);
  else
    wide_transom(site, rooms.wall, open, window);
  furnish_and_look(site, rooms);
}

void lampshade(Site& site) {
  const double h = site.between(2.2, 2.8), l = site.between(2, 4), d = site.between(2, 4);
  const Space room{0, l, 0, h, -0.5 * d, 0.5 * d};
  site.part("shell", shell(room, 0));
  const double sx = site.between(0.2, 0.6), sy = site.between(0.2, 0.6),
               sz = site.between(0.2, 0.6);
  const double z = site.between(room.z0 + 0.1, room.z1 - 0.1 - sz);
  const double x = site.between(1, l - 0.1 - sx), y = site.between(1.4, h - 0.15 - sy);
  constexpr double kOff = 0.01;  // distance from the adjacent wall and floor
  const char* const names[] = {"shade", "sconce", "cupboard"};
  const Side mouths[] = {kFloor, kCeiling, kX0};
  const int which = site.count_between(0, 2);
  Space shade{x, x + sx, y, y + sy, z, z + sz};
  if (which != 0) shade.x0 = l - kOff - sx, shade.x1 = l - kOff;
  if (which == 2) shade.y0 = kOff, shade.y1 = kOff + sy;
  site.part(names[which], shell(shade, mouths[which]));
  site.opening(mouth_of(shade, mouths[which]));
  const Quad quad = lamp_in(site, shade, mouths[which]);
  site.lamp(names[which], quad, 40);
  furnish(site, room);
  site.camera(room);
}

}  // namespace tdpt::testing
