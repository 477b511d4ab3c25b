#include "libcommon/testing/rooms/plan_walls.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt::testing {
namespace {

const Vec3d kUp{0, 1, 0};

Quad turned_round(const Quad& q) {
  return {q[3], q[2], q[1], q[0]};
}

std::vector<double> sorted_cuts(std::vector<double> cuts) {
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  return cuts;
}

bool lies_in(const WallOpening& o, double y0, double y1, double s0, double s1) {
  return y0 >= o.y0 && y1 <= o.y1 && s0 >= o.z0 && s1 <= o.z1;
}

std::vector<Vec3d> corners_of(const WallOpening& o) {
  return {{o.z0, o.y0, 0}, {o.z1, o.y0, 0}, {o.z1, o.y1, 0}, {o.z0, o.y1, 0}};
}

std::vector<Quad> both_faces(const Wall& wall, const std::vector<WallOpening>& holes) {
  std::vector<Quad> quads = pierced_face(wall.near, holes, true);
  append(quads, pierced_face(wall.far, holes, false));
  return quads;
}

KnownAperture aperture(const Wall& wall, const std::vector<Vec3d>& corners) {
  KnownAperture o{{}, -wall.out, wall.thickness};
  for (const Vec3d& c : corners) o.outline.push_back(wall.at(c.x, c.y, 0.5 * wall.thickness));
  return o;
}

// Fills the area between the arc, which begins at the third corner, and the top of the rectangle
// around it.
void add_spandrels(const Face& face, const std::vector<Vec3d>& corners, double top, bool forwards,
                   std::vector<Quad>& out) {
  for (size_t i = 2; i + 1 < corners.size(); ++i) {
    const Vec3d &p = corners[i], &q = corners[i + 1];
    const Quad strip{face.at(q.x, q.y), face.at(p.x, p.y), face.at(p.x, top), face.at(q.x, top)};
    out.push_back(forwards ? strip : turned_round(strip));
  }
}

}  // namespace

void append(std::vector<Quad>& to, const std::vector<Quad>& quads) {
  to.insert(to.end(), quads.begin(), quads.end());
}

Vec3d Face::at(double s, double y) const {
  const double t = (s - s0) / (s1 - s0);
  return a * (1 - t) + b * t + kUp * y;
}

Vec3d Wall::at(double s, double y, double depth) const {
  return near.at(s, y) + out * depth;
}

Wall wall_between(const Space& near, const Space& far) {
  return {{{near.x1, 0, near.z0}, {near.x1, 0, near.z1}, 0, near.depth(), near.y0, near.y1},
          {{far.x0, 0, far.z0},
           {far.x0, 0, far.z1},
           far.z0 - near.z0,
           far.z1 - near.z0,
           far.y0,
           far.y1},
          {1, 0, 0},
          far.x0 - near.x1};
}

std::vector<Wall> walls_along(const std::vector<Vec3d>& points, double thickness, double near_y0,
                              double near_y1, double far_y0, double far_y1) {
  const auto along = [&](size_t i) { return normalize(points[i + 1] - points[i]); };
  const auto out = [&](size_t i) { return cross(kUp, along(i)); };
  std::vector<Vec3d> outer;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3d before = out(i > 0 ? i - 1 : 0), after = out(std::min(i, points.size() - 2));
    outer.push_back(points[i] + (before + after) * (thickness / (1 + dot(before, after))));
  }
  std::vector<Wall> walls;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const auto s = [&](const Vec3d& p) { return dot(p - points[i], along(i)); };
    walls.push_back({{points[i], points[i + 1], 0, s(points[i + 1]), near_y0, near_y1},
                     {outer[i], outer[i + 1], s(outer[i]), s(outer[i + 1]), far_y0, far_y1},
                     out(i),
                     thickness});
  }
  return walls;
}

std::vector<Quad> pierced_face(const Face& face, const std::vector<WallOpening>& holes,
                               bool forwards) {
  std::vector<double> ys{face.y0, face.y1}, ss{face.s0, face.s1};
  for (const WallOpening& o : holes) {
    ys.insert(ys.end(), {o.y0, o.y1});
    ss.insert(ss.end(), {o.z0, o.z1});
  }
  ys = sorted_cuts(ys), ss = sorted_cuts(ss);
  std::vector<Quad> quads;
  for (size_t i = 0; i + 1 < ys.size(); ++i)
    for (size_t j = 0; j + 1 < ss.size(); ++j) {
      const double y0 = ys[i], y1 = ys[i + 1], s0 = ss[j], s1 = ss[j + 1];
      if (std::any_of(holes.begin(), holes.end(),
                      [&](const WallOpening& o) { return lies_in(o, y0, y1, s0, s1); }))
        continue;
      const Quad q{face.at(s0, y0), face.at(s1, y0), face.at(s1, y1), face.at(s0, y1)};
      quads.push_back(forwards ? q : turned_round(q));
    }
  return quads;
}

std::vector<Quad> lining(const Wall& wall, const std::vector<Vec3d>& corners) {
  std::vector<Quad> quads;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d &p = corners[i], &q = corners[(i + 1) % corners.size()];
    quads.push_back({wall.near.at(p.x, p.y), wall.near.at(q.x, q.y), wall.far.at(q.x, q.y),
                     wall.far.at(p.x, p.y)});
  }
  return quads;
}

std::vector<Quad> lining(const Wall& wall, const WallOpening& opening) {
  return lining(wall, corners_of(opening));
}

std::vector<Quad> pierced(const Wall& wall, const std::vector<WallOpening>& openings,
                          bool threshold) {
  std::vector<Quad> quads = both_faces(wall, openings);
  for (const WallOpening& o : openings) {
    std::vector<Quad> edges = lining(wall, o);
    if (!threshold && o.y0 == wall.near.y0) edges.erase(edges.begin());
    append(quads, edges);
  }
  return quads;
}

void pierce(Site& site, const Wall& wall, const std::vector<WallOpening>& openings) {
  site.part("wall", pierced(wall, openings));
  for (const WallOpening& o : openings) site.opening(aperture(wall, o));
}

std::vector<Quad> pierced_as_one(const Wall& wall, const std::vector<WallOpening>& openings,
                                 const std::vector<Vec3d>& corners) {
  std::vector<Quad> quads = both_faces(wall, openings);
  append(quads, lining(wall, corners));
  return quads;
}

KnownAperture aperture(const Wall& wall, const WallOpening& opening) {
  return aperture(wall, corners_of(opening));
}

std::vector<Vec3d> RoundArch::corners() const {
  const double middle = 0.5 * (s0 + s1), r = radius();
  std::vector<Vec3d> all{{s0, y0, 0}, {s1, y0, 0}};
  for (int k = 0; k <= segments; ++k) {
    const double t = std::numbers::pi * k / segments;
    all.push_back({middle + r * std::cos(t), y0 + springing + r * std::sin(t), 0});
  }
  return all;
}

std::vector<Quad> pierced(const Wall& wall, const RoundArch& arch) {
  constexpr double kAbove = 0.05;  // so that no spandrel is a triangle
  const std::vector<Vec3d> corners = arch.corners();
  const WallOpening around{arch.y0, arch.top() + kAbove, arch.s0, arch.s1};
  std::vector<Quad> quads = both_faces(wall, {around});
  add_spandrels(wall.near, corners, around.y1, true, quads);
  add_spandrels(wall.far, corners, around.y1, false, quads);
  append(quads, lining(wall, corners));
  return quads;
}

KnownAperture aperture(const Wall& wall, const RoundArch& arch) {
  return aperture(wall, arch.corners());
}

std::vector<Quad> shell(const Space& s, unsigned open) {
  const auto at = [&](int x, int y, int z) {
    return Vec3d{x ? s.x1 : s.x0, y ? s.y1 : s.y0, z ? s.z1 : s.z0};
  };
  const std::pair<Side, Quad> sides[] = {
      {kX0, {at(0, 0, 1), at(0, 0, 0), at(0, 1, 0), at(0, 1, 1)}},
      {kX1, {at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0)}},
      {kZ0, {at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)}},
      {kZ1, {at(1, 0, 1), at(0, 0, 1), at(0, 1, 1), at(1, 1, 1)}},
      {kFloor, {at(0, 0, 1), at(1, 0, 1), at(1, 0, 0), at(0, 0, 0)}},
      {kCeiling, {at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1)}}};
  std::vector<Quad> quads;
  for (const auto& [side, quad] : sides)
    if ((open & side) == 0) quads.push_back(quad);
  return quads;
}

}  // namespace tdpt::testing
