// An opening through which lines pass, and how to find it: the fullest voxel, the lines around it,
// the plane of their waist, the least tube there, the hull of the crossings within it.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "tools/portalfit/bundle.h"
#include "tools/portalfit/limits.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/tube.h"

namespace tdpt {

struct Aperture {
  Tube tube;
  Polygon polygon;  ///< in the middle plane of the tube [metres]
  Bundle lines;     ///< those that cross it along the normal
};

/// Those of `lines` that cross the aperture along its normal.
Bundle lines_across(const Bundle& lines, const Aperture& a);

/// The convex outline of an opening with these crossings, without outliers; empty if there is none.
Polygon outline_of(std::vector<Vec2d> points, const FitLimits& limits);

/// The same for crossings known to belong to the opening: none is an outlier. Where a gap
/// narrows to nothing few lines pass, and light that misses its portal costs a render more than a
/// portal that is slightly too large.
Polygon whole_outline(const std::vector<Vec2d>& points, const FitLimits& limits);

/// The aperture among `lines` close to `tube`, with its tube and outline. `again`: `tube` is the
/// result of an earlier fit.
std::optional<Aperture> outlined(const FitInput& in, const Bundle& lines, const Tube& tube,
                                 bool again = false);

/// The waist around the fullest voxel of `lines`, a voxel deep: where an aperture may be.
std::optional<Tube> find_waist(const FitInput& in, const Bundle& lines);

/// Number of the `lines` near `tube` over the area of their crossings with its middle plane,
/// outliers left out [1/m2]: a cheap guess at the density of the aperture there; 0 if there is
/// none.
double density_near(const FitInput& in, const Bundle& lines, const Tube& tube);

/// The aperture around the fullest voxel of `lines`.
std::optional<Aperture> find_aperture(const FitInput& in, const Bundle& lines);

}  // namespace tdpt
