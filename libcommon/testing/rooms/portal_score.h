// Scores how well portals fill openings of known position.
//
// Lines of an opening: from uniform points on it along cosine-distributed directions about its
// normal, if they pass both faces of the wall. Lines of a portal: the same on the portal,
// unfiltered.
//
// Obstacles in an opening (bars, slats, furniture) exempt a portal from covering the lines that
// they block. Tightness ignores them: blocked lines count alike for a portal and for the perfect
// one. So a portal over the whole opening and one over the free part are both right.
//
// An opening that bars split into panes may have one portal, or one per pane.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/testing/rooms/room_plan.h"

namespace tdpt::testing {

/// A rectangular opening with corners corner, corner + u, corner + v, corner + u + v in the middle
/// of the wall.
KnownAperture rectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v, const Vec3d& normal,
                        double thickness);

struct Line {
  Vec3d point, direction;
};

/// Whether the straight line through `point` along `direction` passes the opening in the light's
/// direction: through both faces of its wall.
bool passes(const KnownAperture& opening, const Vec3d& point, const Vec3d& direction);

/// Lines of the opening that nothing in it blocks; fewer than `count` if hardly any are free.
std::vector<Line> free_lines(const KnownAperture& opening, size_t count);

/// Share of the opening's free lines that cross one of the portals in the direction of its normal.
double coverage(const KnownAperture& opening, const std::vector<Portal>& portals);

/// Share of the portal's lines that pass one of the openings, relative to that of a perfect portal
/// in the middle of the wall of `opening`.
double tightness(const Portal& portal, const KnownAperture& opening,
                 const std::vector<KnownAperture>& openings);

/// Area-weighted normal of a portal, unit.
Vec3d mean_normal(const Portal& portal);
double degrees_between(const Vec3d& a, const Vec3d& b);

/// Degrees between a unit normal and that of the opening; beside a door leaf, where two narrow
/// places bound the light, to the nearest normal between theirs.
double angle_to(const KnownAperture& opening, const Vec3d& normal);

/// Score of all portals of a scene against all its openings: the worst of each figure. If several
/// portals fit one opening best, its panes count instead; an optional opening that no portal fits
/// does not count.
struct PortalScore {
  size_t portals = 0, openings = 0;
  double coverage = 1;   ///< minimum over the openings
  double tightness = 1;  ///< minimum over the portals, each against the opening that it fits best
  double angle = 0;      ///< largest angle to the same opening, degrees
  size_t matched = 0;    ///< openings that some portal fits best
  size_t strays = 0;     ///< portals that hardly any light passes: tightness below 0.3
  bool right_number() const { return portals == openings && matched == openings; }
  bool right() const {
    return right_number() && coverage >= 0.98 && tightness >= 0.90 && angle <= 3;
  }
};
PortalScore score(const std::vector<Portal>& portals, const std::vector<KnownAperture>& openings);

/// Hausdorff distance of two convex portals [metres]: no point of one is farther from the other.
double distance(const Portal& a, const Portal& b);
/// Distance to the nearest of `others`; infinite if there is none.
double distance_to_nearest(const Portal& portal, const std::vector<Portal>& others);

}  // namespace tdpt::testing
