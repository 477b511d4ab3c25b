#include "libcommon/testing/rooms/room_site.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace tdpt::testing {
namespace {

void flip(Vec3d& p) {
  p.z = -p.z;
}

void flip(Quad& q) {
  for (Vec3d& p : q) flip(p);
  std::reverse(q.begin(), q.end());
}

void flip(KnownAperture& a) {
  for (Vec3d& p : a.outline) flip(p);
  for (Vec3d& p : a.mouth) flip(p);
  for (Quad& q : a.obstacles) flip(q);
  for (KnownAperture& pane : a.panes) flip(pane);
  flip(a.normal);
}

}  // namespace

Site::Site(RoomKind kind, uint64_t seed) : rng_(seed, 0x700 + static_cast<uint64_t>(kind), 0) {
  room_.kind = kind;
  room_.seed = seed;
}

void Site::part(const std::string& name, std::vector<Quad> quads, double radiance) {
  room_.plan.parts.push_back({name, radiance, std::move(quads)});
}

void Site::opening(KnownAperture aperture) {
  room_.apertures.push_back(std::move(aperture));
}

void Site::lamp(const std::string& how, const Quad& quad, double radiance) {
  room_.lamp = how;
  part("lamp", {quad}, radiance);
}

void Site::lamp(const std::string& how, double radiance, const Space& s, bool beside_opening) {
  const double r = between(0.1, 0.3);
  const double z = between(s.z0 + r + 0.1, s.z1 - r - 0.1);
  const double y = between(s.y0 + (1.2 + r), s.y1 - r - 0.1);
  const double x = between(s.x0 + r + 0.3, s.x1 - r - 0.1);
  const auto facing_x = [&](double at, double way) -> Quad {
    return {{{at, y - r, z - way * r},
             {at, y + r, z - way * r},
             {at, y + r, z + way * r},
             {at, y - r, z + way * r}}};
  };
  const double up = s.y0 + 1.1, down = s.y1 - 0.01;
  Quad q{{{x - r, down, z - r}, {x + r, down, z - r}, {x + r, down, z + r}, {x - r, down, z + r}}};
  if (how == "up")
    q = {{{x - r, up, z + r}, {x + r, up, z + r}, {x + r, up, z - r}, {x - r, up, z - r}}};
  else if (how == "at")
    q = facing_x(s.x1 - 0.05, -1);
  else if (how == "away" && beside_opening)
    q = facing_x(s.x0 + 0.4, 1);
  part("lamp", {q}, radiance);
}

void Site::lamps(const Space& space, bool beside_opening) {
  const char* const ways[] = {"down", "up", "at", "away", "several"};
  room_.lamp = ways[rng_.below(5)];
  if (room_.lamp != "several") return lamp(room_.lamp, 20, space, beside_opening);
  for (uint32_t i = 0, n = 2 + rng_.below(2); i < n; ++i) {
    const char* const way = ways[rng_.below(4)];
    lamp(way, between(5, 30), space, beside_opening);
  }
}

void Site::daylight(const std::string& what, const Vec3d& sun, const Vec3d& sky) {
  room_.lamp = what;
  room_.plan.sun = sun;
  if (length(sky) > 0) {
    std::ostringstream option;
    option << "--environment " << sky.x << "," << sky.y << "," << sky.z;
    room_.sky = option.str();
  }
}

bool Site::before_opening(const Vec3d& low, const Vec3d& high, double free) const {
  return std::any_of(room_.apertures.begin(), room_.apertures.end(), [&](const KnownAperture& o) {
    if (o.optional) return false;
    Vec3d from(INFINITY), to(-INFINITY);
    for (const Vec3d& p : o.outline)
      for (const Vec3d& q : {p, p + o.normal * (0.5 * o.thickness + free)})
        from = min(from, q), to = max(to, q);
    return low.x < to.x && high.x > from.x && low.y < to.y && high.y > from.y && low.z < to.z &&
           high.z > from.z;
  });
}

void Site::obstacles_of_last(const std::vector<Quad>& quads) {
  room_.apertures.back().obstacles = quads;
}

void Site::furniture(const Space& s) {
  for (uint32_t i = 0, n = rng_.below(4); i < n; ++i) {
    const double w = between(0.2, 0.6), d = between(0.2, 0.6), h = between(0.2, 1);
    const double reach = 0.5 * std::hypot(w, d);
    const double x = between(s.x0 + 0.6 + reach, s.x1 - 0.6 - reach);
    const double z = between(s.z0 + reach, s.z1 - reach);
    const double turn = between(0, std::numbers::pi);
    if (s.x1 - s.x0 < 1.3 + 2 * reach) continue;
    const Vec3d middle{x, s.y0, z};
    part("box", box(middle - Vec3d{0.5 * w, 0, 0.5 * d}, middle + Vec3d{0.5 * w, h, 0.5 * d}, turn,
                    middle));
  }
}

void Site::camera(const Space& s) {
  const double edge = 0.5 * s.depth() - 0.15, z = s.middle_z();
  Vec3d &from = room_.plan.camera, &to = room_.plan.look_at;
  const double x = between(0.15, 0.5), y = between(1.2, 1.7);
  from = {s.x0 + x, s.y0 + y, z + between(-edge, edge)};
  const double high = between(0.6, 1.4);
  to = {s.x1, s.y0 + high, z + between(-0.5 * edge, 0.5 * edge)};
  // Some cameras look along the wall.
  if (chance(0.2)) to = {s.x0, s.y0 + 1, z - 0.9 * (from.z - z)};
}

void Site::mirror() {
  for (RoomPlan::Part& part : room_.plan.parts)
    for (Quad& q : part.quads) flip(q);
  for (KnownAperture& a : room_.apertures) flip(a);
  flip(room_.plan.sun);
  flip(room_.plan.camera);
  flip(room_.plan.look_at);
}

void Site::choose_writing() {
  Writing& w = room_.writing;
  w.splitting = static_cast<Splitting>(rng_.below(4));
  if (chance(0.5)) return;
  Placement& p = w.placement;
  const double x = between(-1, 1), y = between(0.1, 1), z = between(-1, 1);
  p.axis = {x, y, z};
  if (room_.kind >= RoomKind::sky_window) p.axis = {0, 1, 0};  // the sky must stay above
  p.angle = between(0, 2 * std::numbers::pi);
  const double units[] = {1, 100, 0.01, 39.37};
  p.scale = units[rng_.below(4)];
  if (!chance(0.5)) return;
  const double mx = between(-1, 1), my = between(-1, 1), mz = between(-1, 1);
  p.move = Vec3d{mx, my, mz} * (1000 * p.scale);
}

KnownRoom Site::finish() {
  if (chance(0.5)) mirror();
  choose_writing();
  return std::move(room_);
}

// ---- Furniture ----
namespace {

constexpr double kHighest = 1.05;
constexpr double kFree = 0.6;  // before walls across x, and before openings in the others

// Boxes around the origin on the floor, not yet rotated.
struct Piece {
  const char* name;
  double wide, deep;  ///< along x and z
  std::vector<std::pair<Vec3d, Vec3d>> boxes;

  void add(const Vec3d& low, const Vec3d& high) { boxes.emplace_back(low, high); }
  void legs(double thick, double high) {
    for (const double x : {-0.5 * wide, 0.5 * wide - thick})
      for (const double z : {-0.5 * deep, 0.5 * deep - thick})
        add({x, 0, z}, {x + thick, high, z + thick});
  }
  void board(double y, double thick) {
    add({-0.5 * wide, y, -0.5 * deep}, {0.5 * wide, y + thick, 0.5 * deep});
  }
};

Piece chest(Site& site) {
  const double w = site.between(0.2, 0.8), d = site.between(0.2, 0.6);
  Piece p{"box", w, d, {}};
  p.board(0, site.between(0.2, 1));
  return p;
}

Piece table(Site& site) {
  const double w = site.between(0.6, 1.6), d = site.between(0.5, 0.9);
  Piece p{"table", w, d, {}};
  const double high = site.between(0.4, 0.8), leg = site.between(0.03, 0.07);
  p.legs(leg, high);
  p.board(high, 0.03);
  return p;
}

Piece chair(Site& site) {
  const double w = site.between(0.38, 0.5);
  Piece p{"chair", w, w, {}};
  const double high = site.between(0.4, 0.48), leg = site.between(0.02, 0.05);
  p.legs(leg, high);
  p.board(high, 0.04);
  p.add({-0.5 * w, high, -0.5 * w}, {0.5 * w, site.between(0.8, kHighest), -0.5 * w + 0.03});
  return p;
}

// Open on one side, with boards between.
Piece shelf(Site& site) {
  const double w = site.between(0.5, 1.4), d = site.between(0.2, 0.4);
  Piece p{"shelf", w, d, {}};
  constexpr double kThick = 0.02;
  const double high = site.between(0.6, kHighest - kThick);
  p.add({-0.5 * w, 0, -0.5 * d}, {-0.5 * w + kThick, high, 0.5 * d});
  p.add({0.5 * w - kThick, 0, -0.5 * d}, {0.5 * w, high, 0.5 * d});
  if (site.chance(0.7)) p.add({-0.5 * w, 0, -0.5 * d}, {0.5 * w, high, -0.5 * d + 0.01});
  for (int k = 0, n = site.count_between(2, 4); k <= n; ++k) p.board(high * k / n, kThick);
  return p;
}

// Skips positions directly before an opening: they would narrow the light's way outside of the
// wall, and the position of its portal would be unknown.
void place(Site& site, const Piece& piece, const Space& s, const Vec3d& at, double turn) {
  std::vector<Quad> quads;
  const Vec3d foot{at.x, s.y0, at.z};
  Vec3d least(INFINITY), most(-INFINITY);
  for (const auto& [low, high] : piece.boxes)
    for (const Quad& q : box(foot + low, foot + high, turn, foot)) {
      quads.push_back(q);
      for (const Vec3d& p : q) least = min(least, p), most = max(most, p);
    }
  if (site.before_opening(least, most, kFree)) return;
  site.part(piece.name, std::move(quads));
}

}  // namespace

void furnish(Site& site, const Space& s) {
  for (int i = 0, n = site.count_between(0, 8); i < n; ++i) {
    Piece (*const pieces[])(Site&) = {chest, table, chair, shelf};
    const Piece piece = pieces[site.count_between(0, 3)](site);
    // Along a wall, or anywhere at any angle.
    const bool along = site.chance(0.5), last = site.chance(0.5);
    const double reach = 0.5 * std::hypot(piece.wide, piece.deep);
    const double edge = along ? 0.5 * piece.deep + 0.01 : reach;
    const double x = site.between(s.x0 + kFree + reach, s.x1 - kFree - reach);
    const double z = site.between(s.z0 + edge, s.z1 - edge);
    const double turn = site.between(0, std::numbers::pi);
    if (s.x1 - s.x0 < 2 * (kFree + reach) || s.depth() < 2 * edge) continue;
    if (along)
      place(site, piece, s, {x, 0, last ? s.z1 - edge : s.z0 + edge}, last ? std::numbers::pi : 0);
    else
      place(site, piece, s, {x, 0, z}, turn);
  }
}

}  // namespace tdpt::testing
