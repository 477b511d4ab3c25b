// Parts shared by the texts for other renderers.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/portalfit/rectangle.h"

namespace tdpt {

/// Comments for the file: what made it, and of which scene. Plain ASCII without control characters,
/// since file names are not trusted.
std::vector<std::string> remarks_on(const PortalFile& file);

/// Portals named portal.0, portal.1, ...: those that let in the sky, and those further in, where
/// the light of the sky has passed another portal. Guiding the sampling of an environment, the
/// latter are of no use: they stand in the texts as comments.
struct SkyPortals {
  std::vector<Portal> outer, inner;
};
SkyPortals sky_portals(const PortalFile& file);
/// `text` with `mark` before each of its lines, after a line that says why the portal is no light.
std::string commented(const Portal& portal, const std::string& text, const std::string& mark);

/// "portal_0" of portal.0.
std::string identifier(const Portal& portal);

/// Shortest decimals that read back as the same number, separated by `between`; no negative zero.
std::string numbers(const std::vector<double>& values, const char* between = " ");

/// Columns of the matrix from a portal's own frame to the world's: points are columns, the last
/// column is the origin.
struct Placement {
  Vec3d x, y, z, origin;

  /// Rows of the 4 x 4 matrix for points as columns.
  std::vector<std::vector<double>> rows() const;
};
/// Placement of a lamp at the centre of the rectangle which shines along its -Z, the way the light
/// goes; width along x, height along y.
Placement shining_along_minus_z(const Rectangle& r);

}  // namespace tdpt
