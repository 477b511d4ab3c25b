// What the texts for other renderers share.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/portalfit/rectangle.h"

namespace tdpt {

/// Who made the file, of which scene: what stands in it as comments. Plain ASCII without control
/// characters, since names of files come from outside.
std::vector<std::string> remarks_on(const PortalFile& file);

/// Shortest decimals that read back as the same number, `between` them; no negative zero.
std::string numbers(const std::vector<double>& values, const char* between = " ");

/// Columns of the matrix from a portal's own frame to the world's: points are columns, the last
/// is the origin.
struct Placement {
  Vec3d x, y, z, origin;

  /// Rows of the 4 x 4 matrix for points as columns.
  std::vector<std::vector<double>> rows() const;
};
/// That of a lamp in the middle of the rectangle which shines along its -Z, the way the light goes,
/// its width along x and its height along y.
Placement shining_along_minus_z(const Rectangle& r);

}  // namespace tdpt
