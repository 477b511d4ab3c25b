// A bundle of light lines that pass one aperture, and the plane of its waist: where a beam has
// least area.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

/// Some of the lines of a grid.
struct Bundle {
  const std::vector<LightLine>* of = nullptr;  ///< grid.lines
  std::vector<uint32_t> which{};               ///< indices into them, ascending

  bool empty() const { return which.empty(); }
  size_t size() const { return which.size(); }
  const LightLine& line(uint32_t l) const { return (*of)[l]; }
  std::vector<LightLine> lines() const;
  /// Those for whose line `keep` holds.
  template <class Keep>
  Bundle where(const Keep& keep) const {
    Bundle kept{of};
    for (const uint32_t l : which)
      if (keep(line(l))) kept.which.push_back(l);
    return kept;
  }
};

/// The densest place of the bundle: centre of the grid's fullest voxel, metres.
Vec3d fullest_place(const LightGrid& grid, const Bundle& bundle);

/// Mean direction of the lines that pass within `radius` of `place`; zero when there are none.
Vec3d mean_direction_near(const Bundle& bundle, const Vec3d& place, double radius);

/// Those of `bundle` that pass the middle of the tube within the connected dense region around its
/// `o`. `h` is the size of the first look [metres].
Bundle members(const Bundle& bundle, const Tube& tube, double h);

/// The plane near `start` that the lines cross within the smallest area: the waist of the bundle.
/// Strays are left out; planes that fewer lines cross are held back. In a thick wall, its middle.
/// The area is that of the moments (square root of their determinant): quick and without local
/// minima, but biased where light comes from one side.
Plane waist(const Bundle& bundle, const Plane& start);

}  // namespace tdpt
