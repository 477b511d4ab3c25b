// All that shines from infinitely far away with a radiance: an environment, which is a map or one
// colour, and suns of some extent.
//
// Directions are unit, in the scene's axes, y up, and point away from the scene ("towards" the
// sky). The map is latitude-longitude, seen from inside: centre -z, three quarters of the width +x,
// top row +y; column u = 0.5 + atan2(x, -z) / (2 pi), row v = acos(y) / pi, both of 0..1.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libcommon/math/alias_table.h"
#include "libcommon/math/vec.h"

namespace tdpt {

class Sky {
 public:
  struct Map {
    int width = 0, height = 0;
    std::vector<Rgb> texels;  ///< radiance [W/m2/sr], finite, not negative; row 0 at the top
  };
  struct Sun {
    Vec3d towards;          ///< unit, its centre
    double half_angle = 0;  ///< [rad], in (0, pi/2)
    Rgb radiance{};         ///< [W/m2/sr]
  };

  /// A map of 1 x 1 is one colour all around; one without texels is black. `rotation` [rad] turns
  /// the map about +y, counter-clockwise seen from above; the suns stay where they are.
  Sky(Map map, double rotation, std::vector<Sun> suns = {});

  /// What is seen looking along `towards` [W/m2/sr].
  Rgb radiance(const Vec3d& towards) const;
  bool one_colour() const { return map_.width == 1 && map_.height == 1; }
  const Map& map() const { return map_; }
  const std::vector<Sun>& suns() const { return suns_; }

  /// Column and row of a direction in the map's texels, [0, width) x [0, height), and the other
  /// way round.
  void raster(const Vec3d& towards, double& x, double& y) const;
  Vec3d towards(double x, double y) const;

 private:
  Map map_;
  double cos_, sin_;
  std::vector<Sun> suns_;
};

/// Draws directions in proportion to luminance x solid angle x a weight.
///
/// Method: cells of the map (of one colour: of a coarse map), each in proportion to its integral,
/// and uniform by solid angle within; suns are entries of the same table. The density is that of
/// the table, exactly.
class SkyDirections {
 public:
  SkyDirections() = default;
  /// `weight`: of a direction, not negative, taken at the middle of each cell; none: 1. The sky
  /// must outlive this.
  explicit SkyDirections(const Sky& sky,
                         const std::function<double(const Vec3d& towards)>& weight = {});

  /// Nothing shines, or all weights are 0.
  bool empty() const { return table_.empty(); }
  /// Integral of luminance x weight over all directions [W/m2 for weight 1].
  double total() const { return total_; }
  /// Unit, towards the sky. Three numbers in [0,1).
  Vec3d sample(double pick, double u, double v) const;
  /// Density of sample() [1/sr].
  double pdf_w(const Vec3d& towards) const;

 private:
  const Sky* sky_ = nullptr;
  int columns_ = 0, rows_ = 0;      // of cells
  std::vector<double> cos_of_row_;  // rows + 1, from 1 to -1
  AliasTable table_;                // cells, row by row, then suns
  double total_ = 0;
};

}  // namespace tdpt
