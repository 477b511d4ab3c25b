// Openings beside each other: panes and gaps in one plane are joined into one opening with bars in
// it, and lines are divided among openings that stand side by side.
#pragma once
#include <optional>
#include <vector>

#include "tools/portalfit/outline.h"

namespace tdpt {

/// Joint geometry of flat shapes.
struct Joint {
  Plane plane;        ///< least squares to all corners, along the mean normal
  Polygon outline;    ///< convex, around all of them
  double open = 0;    ///< share of the outline that the shapes leave open
  bool flat = false;  ///< whether they lie in that plane
};
Joint joint_of(const LightGrid& grid, const std::vector<Aperture>& parts);

/// The least distance between two convex outlines in one plane; 0 if they touch.
double distance_between(const Polygon& a, const Polygon& b);

/// Joins openings in one plane across bars as thin as the grid resolves, and across mullions if
/// most of the joint outline is open; not across the pier between two windows. While there are more
/// than `most` parts, it also joins those whose joint outline is open enough. Each joined opening
/// is fitted again to its lines, which are those of `all`.
std::vector<Aperture> joined_in_planes(const LightGrid& grid, const Bundle& all,
                                       std::vector<Aperture> parts, size_t most);

// Divides the lines of openings that stand beside each other.

/// Points with dot(axis, p) <= limit; `axis` is unit.
struct HalfPlane {
  Vec2d axis;
  double limit = 0;
};

/// The border of `a` at the plane of `b`, in coordinates of the plane of `a`. Openings that share
/// an edge, such as the slit beside a door and the gap above its leaf, each lie on one side of the
/// other's plane. Nothing if the planes are within 30 degrees of parallel, meet farther from either
/// outline than a fifth of its size, or would cut off more than a quarter of `a`.
std::optional<HalfPlane> shared_edge(const Aperture& a, const Aperture& b);

/// For openings side by side, such as the slit beside a door and the gap above it: light through
/// the second crosses the plane of the first beyond its edge and extends its outline there. So each
/// is outlined again by the lines that do not cross the others, at first with the others enlarged.
/// Skips an opening most of whose lines cross others, too: such openings follow each other. All
/// lines are those of `all`.
void part_from_each_other(const LightGrid& grid, const Bundle& all, std::vector<Aperture>& found);

/// For openings that share an edge: lines near it belong to neither yet, and each outline includes
/// some of the other's. Each is clipped at the other's plane; then, the smallest first, each is
/// fitted again to the lines near it that pass no other, if that is better: less area, or more
/// lines. All lines are those of `all`.
void part_at_shared_edges(const LightGrid& grid, const Bundle& all, std::vector<Aperture>& found);

}  // namespace tdpt
