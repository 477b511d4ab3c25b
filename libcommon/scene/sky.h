// Radiance from infinitely far away: an environment, which is a map or one colour, and suns of a
// given angular size.
//
// Directions are unit, in the scene's axes, y up, and point away from the scene ("towards" the
// sky). The map is latitude-longitude, seen from inside: centre -z, three quarters of the width +x,
// top row +y; column u = 0.5 + atan2(x, -z) / (2 pi), row v = acos(y) / pi, both in 0..1.
//
// Radiance is interpolated bilinearly in azimuth and y (the cosine) between the centres of four
// texels. In these coordinates area is solid angle, so sampling in proportion to radiance needs no
// extra table. Columns wrap round; beyond the centres of the first and last row, half rows continue
// their values to the pole.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "libcommon/math/discrete.h"
#include "libcommon/math/vec.h"

namespace tdpt {

class Sky {
 public:
  struct Map {
    int width = 0, height = 0;
    std::vector<Rgb> texels;  ///< radiance [W/m2/sr], finite, not negative; row 0 at the top
  };
  struct Sun {
    Vec3d towards;          ///< unit, of its centre
    double half_angle = 0;  ///< [rad], in (0, pi/2)
    Rgb radiance{};         ///< [W/m2/sr]
  };

  /// A map of 1 x 1 is a uniform sky; one without texels is black. `rotation` [rad] turns the map
  /// about +y, counter-clockwise seen from above, but not the suns.
  Sky(Map map, double rotation, std::vector<Sun> suns = {});

  /// Radiance seen along `towards` [W/m2/sr].
  Rgb radiance(const Vec3d& towards) const {
    return radiance(one_colour() ? Place{towards} : place(towards));
  }
  bool one_colour() const { return map_.width == 1 && map_.height == 1; }
  const Map& map() const { return map_; }
  const std::vector<Sun>& suns() const { return suns_; }
  /// Cosine and sine of the map's rotation.
  double turn_cos() const { return cos_; }
  double turn_sin() const { return sin_; }

  /// Column and row of a direction in the map's texels, [0, width) x [0, height), and the inverse.
  /// Texel i has its centre at i + 0.5.
  void raster(const Vec3d& towards, double& x, double& y) const;
  Vec3d towards(double x, double y) const;

  /// A direction between the centres of four texels: those of columns `column` and the next, rows
  /// `row` - 1 and `row`; [0, width) x [0, height].
  struct Cell {
    int column = 0, row = 0;
    double across = 0, down = 0;  ///< in 0..1, in azimuth and in y
  };
  Cell cell(const Vec3d& towards) const;
  Vec3d towards(const Cell& cell) const;
  /// Indices into map().texels: upper left, upper right, lower left, lower right.
  std::array<size_t, 4> corners(const Cell& cell) const;

  /// A direction with its position in the map, whose computation takes an arc tangent.
  struct Place {
    Vec3d towards;
    Cell cell{};                     ///< this and `texels` are undefined without texels
    std::array<size_t, 4> texels{};  ///< its corners
  };
  Place place(const Vec3d& towards) const;
  /// The same with an error of 2e-5 rad in azimuth, in half the time: for approximate tables.
  Place rough_place(const Vec3d& towards) const;
  Rgb radiance(const Place& place) const;
  /// Solid angle of each cell in a row [sr].
  double solid_angle(int row) const;

 private:
  Cell cell(const Vec3d& towards, double azimuth) const;

  Map map_;
  double cos_, sin_;
  std::vector<double> top_;  // y at the upper edge of each row of cells, then -1
  std::vector<Sun> suns_;
};

/// Samples directions in proportion to luminance x a weight, exactly.
///
/// Method: a cumulative table over blocks of cells, each with its integral; within a block a cell,
/// by summing the cells when the block is drawn; within a cell the inverse distribution of the
/// bilinear luminance. Blocks keep the table small. Suns are entries of the same table.
class SkyDirections {
 public:
  SkyDirections() = default;
  /// `weight`: of a direction, not negative, evaluated at the middle of each block (for a coarse
  /// map at least 128 x 64 parts); none: 1. Keeps a reference to the sky.
  explicit SkyDirections(const Sky& sky,
                         const std::function<double(const Vec3d& towards)>& weight = {});

  /// Whether nothing shines, or all weights are 0.
  bool empty() const { return table_.empty(); }
  /// Integral of luminance x weight over all directions [W/m2 for weight 1].
  double total() const { return total_; }
  /// Unit, towards the sky. Three numbers in [0,1).
  Vec3d sample(double pick, double u, double v) const { return draw(pick, u, v).towards; }
  /// The same with its position in the map, which need not be computed again.
  Sky::Place draw(double pick, double u, double v) const;
  /// Density of sample() [1/sr]: luminance x weight / total(). `place`: in this sky.
  double pdf_w(const Sky::Place& place) const;
  double pdf_w(const Vec3d& towards) const { return empty() ? 0 : pdf_w(sky_->place(towards)); }
  /// Weight of the block that contains `cell`, and of a sun.
  double weight_at(const Sky::Cell& cell) const {
    return weight(static_cast<size_t>(block_at(cell)));
  }
  double weight_of_sun(size_t i) const { return weight(static_cast<size_t>(blocks()) + i); }

 private:
  using Corners = std::array<double, 4>;  // luminance, ordered as in Sky::corners
  struct Block {
    int column, row, end_column, end_row;  // of fine cells
  };
  int fine_columns() const { return sky_->map().width * split_; }
  int fine_rows() const { return (sky_->map().height + 1) * split_down_; }
  int blocks() const { return columns_ * rows_; }
  void choose_blocks(bool weighted);
  Block block(int i) const;
  int block_at(const Sky::Cell& cell) const;
  Corners corners(int fine_column, int fine_row) const;
  double integral(int fine_column, int fine_row) const;
  Vec3d middle(const Block& block) const;
  void choose_cell(const Block& block, int& column, int& row, double& u, double& v) const;
  Sky::Place in_block(const Block& block, double u, double v) const;
  Vec3d in_sun(const Sky::Sun& sun, double u, double v) const;
  double weight(size_t i) const { return weights_.empty() ? 1 : weights_[i]; }

  const Sky* sky_ = nullptr;
  int split_ = 1, split_down_ = 1;  // fine cells per cell, equal in azimuth and in y
  int block_ = 1;                   // fine cells per block, both ways
  int columns_ = 0, rows_ = 0;      // number of blocks
  std::vector<float> weights_;      // of blocks row by row, then suns; empty: all 1
  CumulativeTable table_;           // the same
  double total_ = 0;
};

}  // namespace tdpt
