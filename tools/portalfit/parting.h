// Openings that stand beside each other: which line belongs to which.
#pragma once
#include <optional>
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// Points with dot(axis, p) <= limit; `axis` is unit.
struct HalfPlane {
  Vec2d axis;
  double limit = 0;
};

/// Where the plane of `b` bounds `a`, in coordinates of the plane of `a`. Openings that share an
/// edge, as the slit beside a door and the gap above its leaf, lie each on one side of the other.
/// Nothing where the planes are within 30 degrees of parallel, or meet farther from either outline
/// than a fifth of its size, or would cut off more than a quarter of `a`.
std::optional<HalfPlane> shared_edge(const Aperture& a, const Aperture& b);

/// Openings side by side, as the slit beside a door and the gap above it: light through the second
/// crosses the plane of the first beyond its edge and draws its outline there. So each is outlined
/// again by the lines that do not cross the others, at first with the others wider than found. Not
/// where most of its lines cross others, too: such openings follow each other. All lines
/// are those of `all`, found in a grid of voxels of that side [metres].
void part_from_each_other(const Bundle& all, std::vector<Aperture>& found, double voxel);

/// Lines of `all` that pass none of `others`.
Bundle lines_beside(const Bundle& all, const std::vector<Aperture>& others);

/// Openings that share an edge: lines near it belong to neither yet, and each has drawn some of the
/// other's. Each is cut off at the other's plane; then, the smallest first, each is fitted again to
/// the lines near it that pass no other, as far as that is better: of less area, or with more
/// lines. All lines are those of `all`.
void part_at_shared_edges(const Bundle& all, std::vector<Aperture>& found);

}  // namespace tdpt
