// A bundle of lines that pass one aperture, and the plane of its waist, where the beam has least
// area.
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
  /// The lines for which `keep` holds.
  template <class Keep>
  Bundle where(const Keep& keep) const {
    Bundle kept{of};
    for (const uint32_t l : which)
      if (keep(line(l))) kept.which.push_back(l);
    return kept;
  }
};

/// Centre of the voxel that most lines of the bundle pass [metres].
Vec3d fullest_place(const LightGrid& grid, const Bundle& bundle);

/// Whether the line passes within `radius` of `place` [metres].
bool passes_near(const LightLine& line, const Vec3d& place, double radius);

/// Mean direction of the lines that pass within `radius` of `place`; zero if there are none.
Vec3d mean_direction_near(const Bundle& bundle, const Vec3d& place, double radius);

/// The lines that cross the tube's middle plane within the connected dense region around its `o`.
/// `h`: cell size of the first histogram [metres].
Bundle members(const Bundle& bundle, const Tube& tube, double h);

/// The plane near `start` that the lines cross within the least area: the waist of the bundle; in a
/// thick wall, its middle. Outliers are left out, and planes that fewer lines cross are penalised.
/// The area is that of the moments (square root of their determinant): fast and without local
/// minima, but biased if light comes from one side.
Plane waist(const Bundle& bundle, const Plane& start);

}  // namespace tdpt
