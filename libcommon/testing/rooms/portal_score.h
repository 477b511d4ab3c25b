// How well portals fill openings whose place is known.
//
// Lines of an opening: uniform places on it, cosine directions about its normal, those that pass
// both faces of the wall. Lines of a portal: the same on the portal, not filtered.
//
// What stands in an opening (bars, slats, furniture) frees a portal from covering the lines that it
// stops. Tightness leaves it out of account: those lines count alike for a portal and for the
// perfect one. So a portal over the whole and one over what is left free are both right.
//
// An opening that bars split into panes may have one portal, or one for each pane.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/testing/rooms/room_plan.h"

namespace tdpt::testing {

/// A rectangular opening: corner, corner + u, corner + v, corner + u + v on the wall's middle.
KnownAperture rectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v, const Vec3d& normal,
                        double thickness);

struct Line {
  Vec3d point, direction;
};

/// Whether the straight line through `point` along `direction` goes through the opening, the
/// light's way: through both faces of its wall.
bool passes(const KnownAperture& opening, const Vec3d& point, const Vec3d& direction);

/// Lines of the opening that nothing in it stops; fewer than `count` if hardly any are free.
std::vector<Line> free_lines(const KnownAperture& opening, size_t count);

/// Share of the opening's free lines that cross one of the portals along its normal.
double coverage(const KnownAperture& opening, const std::vector<Portal>& portals);

/// Share of the portal's lines that pass one of the openings, over the same share of a perfect
/// portal in the middle of the wall of `opening`.
double tightness(const Portal& portal, const KnownAperture& opening,
                 const std::vector<KnownAperture>& openings);

/// Area-weighted normal of a portal, unit.
Vec3d mean_normal(const Portal& portal);
double degrees_between(const Vec3d& a, const Vec3d& b);

/// Degrees between a unit normal and that of the opening; beside a leaf, where two narrow places
/// bound what light passes, the nearest normal between theirs.
double angle_to(const KnownAperture& opening, const Vec3d& normal);

/// All portals of a scene against all its openings. The worst of each figure. An opening that more
/// than one portal fits best counts as its panes; an optional one that none fits does not count.
struct PortalScore {
  size_t portals = 0, openings = 0;
  double coverage = 1;   ///< over the openings
  double tightness = 1;  ///< over the portals, each against the opening it fits best
  double angle = 0;      ///< degrees, to the same opening
  size_t matched = 0;    ///< openings that are the best one of some portal
  size_t strays = 0;     ///< portals that hardly any light passes: tightness below 0.3
  bool right_number() const { return portals == openings && matched == openings; }
  bool right() const {
    return right_number() && coverage >= 0.98 && tightness >= 0.90 && angle <= 3;
  }
};
PortalScore score(const std::vector<Portal>& portals, const std::vector<KnownAperture>& openings);

}  // namespace tdpt::testing
