// pbrt's transformations of coordinates.
#pragma once
#include <span>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::pbrt {

/// Throws InputError at `place` for a map that flattens space.
Affine inverse(const Affine& a, const Place& place);

Affine translated(const Vec3d& by);
Affine scaled_by(const Vec3d& by);
/// About `axis`; a zero axis turns nothing.
Affine rotated(double degrees, const Vec3d& axis);
/// From the world to a camera that looks along +z.
Affine looking(const Vec3d& from, const Vec3d& at, const Vec3d& up, const Place& place);
/// Of sixteen numbers, column by column.
Affine affine_of_matrix(std::span<const double> m, const Place& place);

}  // namespace tdpt::foreign::pbrt
