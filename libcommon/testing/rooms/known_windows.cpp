// Rooms lit through windows: with bars, blinds or curtains, in bays and in rows.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/testing/rooms/known_kinds.h"

namespace tdpt::testing {
namespace {

struct Lit {
  Space room, outside;
  Wall wall;
  WallOpening window;
};

// A room, and a lit space behind it as shallow as a pocket or deeper, with a window of random area
// [m2].
Lit lit_room(Site& site, double least, double most) {
  const double h = site.between(2.4, 2.8), d = site.between(3, 4.5),
               t = site.log_between(0.01, 0.3);
  const double a = site.between(2.5, 4.5), b = site.log_between(1, 3.5);
  const Space room{0, a, 0, h, -0.5 * d, 0.5 * d};
  const Space outside{a + t, a + t + b, 0, h, -0.5 * d, 0.5 * d};
  const double area = site.between(least, most), ratio = site.log_between(0.8, 1.7);
  const double high = std::min(std::sqrt(area / ratio), 1.5), wide = area / high;
  const double sill = site.between(0.4, std::min(0.9, h - 0.2 - high));
  const double s = site.between(0.3, d - 0.3 - wide);
  site.part("shell", shell(room, kX1));
  site.part("shell", shell(outside, kX0));
  return {room, outside, wall_between(room, outside), {sill, sill + high, s, s + wide}};
}

void furnish_and_look(Site& site, const Space& room, const Space& outside) {
  site.lamps(outside);
  furnish(site, room);
  site.camera(room);
}

// A bar across the rectangle, in the middle of the wall.
void add_bar(const Wall& wall, const WallOpening& o, double deep, std::vector<Quad>& out) {
  append(out, box(wall.at(o.z0, o.y0, 0.5 * (wall.thickness - deep)),
                  wall.at(o.z1, o.y1, 0.5 * (wall.thickness + deep))));
}

// A vertical sheet across x.
Quad sheet(double x, double y0, double y1, double z0, double z1) {
  return {{{x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}}};
}

// Windows of equal size, evenly spaced along a wall.
std::vector<WallOpening> evenly(const Wall& wall, int n, double sill, double high, double wide) {
  std::vector<WallOpening> windows;
  for (int k = 0; k < n; ++k) {
    const double s = wall.near.s1 * (k + 0.5) / n;
    windows.push_back({sill, sill + high, s - 0.5 * wide, s + 0.5 * wide});
  }
  return windows;
}

// One or more lamps for every few metres along z.
void lamps_along_z(Site& site, const Space& s) {
  const int n = std::max(1, static_cast<int>(s.depth() / 2.5));
  for (int k = 0; k < n; ++k) {
    Space piece = s;
    piece.z0 = s.z0 + s.depth() * k / n, piece.z1 = s.z0 + s.depth() * (k + 1) / n;
    site.lamps(piece);
  }
}

}  // namespace

std::vector<Quad> slats(const Wall& wall, const WallOpening& o, int n, double wide, double tilt,
                        double x, double beyond) {
  std::vector<Quad> quads;
  const Vec3d half = Vec3d{std::cos(tilt), std::sin(tilt), 0} * (0.5 * wide);
  for (int k = 0; k < n; ++k) {
    const double y = o.y0 + (o.y1 - o.y0) * (k + 0.5) / n;
    const Vec3d a{x, y, wall.near.at(o.z0 - beyond, 0).z},
        b{x, y, wall.near.at(o.z1 + beyond, 0).z};
    quads.push_back({a - half, b - half, b + half, a + half});
  }
  return quads;
}

void glazing_bars(Site& site) {
  const Lit lit = lit_room(site, 1, 2.5);
  const WallOpening& o = lit.window;
  int rows = site.count_between(2, 3), columns = site.count_between(2, 4);
  if (site.chance(0.5)) std::swap(rows, columns);
  const double wide = site.between(0.03, 0.06), deep = site.between(0.03, 0.05);
  site.part("wall", pierced(lit.wall, {o}));
  KnownAperture whole = aperture(lit.wall, o);
  const double pane_y = (o.y1 - o.y0 - (rows - 1) * wide) / rows;
  const double pane_s = (o.z1 - o.z0 - (columns - 1) * wide) / columns;
  for (int i = 0; i < rows; ++i) {
    const double y = o.y0 + i * (pane_y + wide);
    if (i > 0) add_bar(lit.wall, {y - wide, y, o.z0, o.z1}, deep, whole.obstacles);
    for (int j = 0; j < columns; ++j) {
      const double s = o.z0 + j * (pane_s + wide);
      if (i == 0 && j > 0) add_bar(lit.wall, {o.y0, o.y1, s - wide, s}, deep, whole.obstacles);
      KnownAperture pane = aperture(lit.wall, WallOpening{y, y + pane_y, s, s + pane_s});
      pane.thickness = deep;
      whole.panes.push_back(pane);
    }
  }
  site.part("bars", whole.obstacles);
  site.opening(whole);
  furnish_and_look(site, lit.room, lit.outside);
}

void blinds(Site& site) {
  const Lit lit = lit_room(site, 0.6, 2);
  const Wall& wall = lit.wall;
  site.part("wall", pierced(wall, {lit.window}));
  const int n = site.count_between(8, 40);
  const double wide = (lit.window.y1 - lit.window.y0) / n * site.between(0.7, 1.1);
  const double steep = site.between(10, 60) * kDegree, tilt = site.chance(0.5) ? steep : -steep;
  const double reach = 0.5 * wide * std::cos(tilt), off = reach + site.between(0.01, 0.03);
  const bool inside = site.chance(0.5), fits = 2 * reach < wall.thickness;
  const double x = fits     ? lit.room.x1 + 0.5 * wall.thickness
                   : inside ? lit.room.x1 - off
                            : lit.outside.x0 + off;
  KnownAperture o = aperture(wall, lit.window);
  o.obstacles = slats(wall, lit.window, n, wide, tilt, x, fits ? 0 : 0.02);
  site.part("slats", o.obstacles);
  site.opening(o);
  furnish_and_look(site, lit.room, lit.outside);
}

void curtains(Site& site) {
  Lit lit = lit_room(site, 0.8, 2.2);
  WallOpening& o = lit.window;
  const bool is_door = site.chance(0.4);
  if (is_door) {
    const double high = site.between(1.9, 2.1), wide = site.between(0.8, 1.2);
    o = {0, high, o.z0, std::min(o.z0 + wide, lit.wall.near.s1 - 0.3)};
  }
  site.part("wall", pierced(lit.wall, {o}));
  const double z0 = lit.wall.near.at(o.z0, 0).z, z1 = lit.wall.near.at(o.z1, 0).z;
  const double gap = (z1 - z0) * site.between(0.4, 0.6), beyond = site.between(0.1, 0.2);
  const double off = site.between(0.02, 0.05);
  const double x = site.chance(0.5) ? lit.room.x1 - off : lit.outside.x0 + off;
  const bool to_floor = is_door || site.chance(0.5);
  const double y0 = to_floor ? 0.01 : o.y0 - beyond, y1 = o.y1 + beyond;
  const bool pair = site.chance(0.6);
  const double left = pair ? z0 + (z1 - z0 - gap) * site.between(0.3, 0.7) : z1 - gap;
  std::vector<Quad> sheets{sheet(x, y0, y1, z0 - beyond, left)};
  if (pair) sheets.push_back(sheet(x, y0, y1, left + gap, z1 + beyond));
  site.part("curtains", sheets);
  // A portal may be in the wall or in the gap beside the sheets: the light passes both. Beside a
  // single sheet the gap reaches to the jamb.
  KnownAperture a = aperture(lit.wall, o);
  const double end = pair ? left + gap : z1;
  const double face = x < lit.room.x1 ? lit.room.x1 : lit.outside.x0, end_x = pair ? x : face;
  const double low = o.y0 - 1, high = o.y1 + 1;
  a.mouth = {{x, low, left}, {end_x, low, end}, {end_x, high, end}, {x, high, left}};
  site.opening(a);
  furnish_and_look(site, lit.room, lit.outside);
}

void bay(Site& site) {
  const double angle = site.between(30, 60) * kDegree, t = site.log_between(0.03, 0.2);
  const double side = site.between(0.9, 1.3), middle = site.between(0.9, 1.4);
  const double h = site.between(2.4, 2.8), l = site.between(2.5, 4);
  const double m = 0.5 * middle + side * std::cos(angle), x = l + side * std::sin(angle);
  const double d = 2 * m + site.between(0.6, 1.6);
  const Space room{0, l, 0, h, -0.5 * d, 0.5 * d};
  const Space outside{l + t, x + t + site.between(1.2, 2.5), -0.3, h + 0.3, -0.5 * d, 0.5 * d};
  const Vec3d corners[] = {{l, 0, -m}, {x, 0, -0.5 * middle}, {x, 0, 0.5 * middle}, {l, 0, m}};
  const auto level = [&](double y) -> Quad {
    const Vec3d up{0, y, 0};
    return {corners[3] + up, corners[2] + up, corners[1] + up, corners[0] + up};
  };
  site.part("shell", shell(room, kX1));
  site.part("shell", {level(0), level(h)});
  site.part("shell", shell(outside, kX0));
  std::vector<Vec3d> line{{l, 0, room.z0}};
  line.insert(line.end(), std::begin(corners), std::end(corners));
  line.push_back({l, 0, room.z1});
  const std::vector<Wall> walls = walls_along(line, t, 0, h, outside.y0, outside.y1);
  // Avoids the mitres.
  const double margin = t * std::tan(0.5 * angle) + site.between(0.06, 0.12);
  const double sill = site.between(0.5, 0.9), high = site.between(0.9, 1.3);
  for (size_t k = 0; k < walls.size(); ++k) {
    const bool window = k >= 1 && k <= 3;
    const double s1 = walls[k].near.s1 - margin;
    pierce(site, walls[k],
           window ? std::vector<WallOpening>{{sill, sill + high, margin, s1}}
                  : std::vector<WallOpening>{});
  }
  furnish_and_look(site, room, {x + t, outside.x1, outside.y0, outside.y1, room.z0, room.z1});
}

void windows_in_row(Site& site) {
  const double h = site.between(2.4, 3), d = site.between(4, 8), l = site.between(3, 5);
  const double t = site.log_between(0.02, 0.3), c = site.between(1, 2);
  const bool round_corner = site.chance(0.5);
  const Space room{0, l, 0, h, -0.5 * d, 0.5 * d};
  const double end = round_corner ? room.z1 + t + c : room.z1;
  const Space corridor{l + t, l + t + c, 0, h, room.z0, end};
  const Space rest{0, l + t, 0, h, room.z1 + t, end};  // along the other wall
  site.part("shell", shell(room, kX1 | (round_corner ? kZ1 : 0u)));
  site.part("shell", shell(corridor, kX0));
  std::vector<Vec3d> line{{l, 0, room.z0}, {l, 0, room.z1}};
  if (round_corner) {
    site.part("shell", shell(rest, kX1 | kZ0));
    line.push_back({0, 0, room.z1});
  }
  const std::vector<Wall> walls = walls_along(line, t, 0, h, 0, h);
  const int n = site.count_between(3, 8);
  const int others = round_corner ? std::max(1, static_cast<int>(n * l / (l + d))) : 0;
  const double spacing = std::min(d / (n - others), others > 0 ? l / others : d);
  const double wide = std::min(site.between(0.35, 0.8), 0.6 * spacing);
  const double sill = site.between(0.7, 1), high = site.between(0.5, 1.2);
  pierce(site, walls[0], evenly(walls[0], n - others, sill, high, wide));
  if (round_corner) pierce(site, walls[1], evenly(walls[1], others, sill, high, wide));
  lamps_along_z(site, corridor);
  if (round_corner) site.lamps(rest);
  furnish(site, {room.x0, room.x1, 0, h, room.z0, room.z1 - 0.6});
  site.camera(room);
}

void lamp_outside(Site& site) {
  const double h = site.between(2.3, 2.8), l = site.between(2, 4), d = site.between(2.5, 4);
  const double t = site.log_between(0.01, 0.3);
  const Space room{0, l, 0, h, -0.5 * d, 0.5 * d};
  const Wall wall = wall_between(room, {l + t, l + t + 1, 0, h, room.z0, room.z1});
  const double high = site.between(0.7, 1.4), wide = site.between(0.7, 1.5);
  const double sill = site.between(0.3, h - 0.2 - high), s = site.between(0.3, d - 0.3 - wide);
  const WallOpening o{sill, sill + high, s, s + wide};
  site.part("shell", shell(room, kX1));
  site.part("wall", pierced(wall, {o}));
  KnownAperture window = aperture(wall, o);
  window.optional = true;
  site.opening(window);
  const double x = l + t + site.between(0.1, 0.2), larger = site.between(0.3, 0.5);
  const Quad lamp =
      sheet(x, o.y0 - larger, o.y1 + larger, room.z0 + o.z0 - larger, room.z0 + o.z1 + larger);
  site.lamp("outside", lamp, 5);
  furnish(site, room);
  site.camera(room);
}

}  // namespace tdpt::testing
