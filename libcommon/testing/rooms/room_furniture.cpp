#include "libcommon/testing/rooms/room_furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt::testing {
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
