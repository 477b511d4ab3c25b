// How much many vertices would bring to one, without visibility: estimates for resampling.h, which
// are more than 0 wherever connect() is and need not be exact.
//
// Ends side by side, in columns, so that several are computed at once. Between simple surfaces an
// estimate is what connect() says, by the same operations. Where a surface is glossy, rounding of
// floats is good enough, the interface takes 1 - f0 of the diffuse lobe, and bent normals darken
// nothing.
#pragma once
#include <array>
#include <vector>

#include "tools/tdpt-render/path/sample/connect.h"

namespace tdpt {

/// Ends on the light's side of what may be connected.
class Ends {
 public:
  // Columns.
  enum Coordinate { x, y, z, facing_x, facing_y, facing_z, kPlaces };
  enum Colour {
    red,
    green,
    blue,
    light_red,
    light_green,
    light_blue,
    // Of glossy ones: unit direction back and shading normal on that side, its cosine to back,
    // alpha^2, and what is reflected at normal incidence and more at grazing.
    back_x,
    back_y,
    back_z,
    normal_x,
    normal_y,
    normal_z,
    cosine,
    alpha2,
    f0_red,
    f0_green,
    f0_blue,
    f90_red,
    f90_green,
    f90_blue,
    kColours
  };

  Ends() = default;
  Ends(Ends&&) = default;  // a copy would know the columns of another
  Ends& operator=(Ends&&) = default;

  /// Whether an end has estimates; another has a place all the same.
  static bool has(const End& end) { return !end.layered || end.opaque; }

  void clear() {
    size_ = 0;
    glossy_ = false;
  }
  void add(const End& end);
  size_t size() const { return size_; }
  /// The light that comes to end i, by which its estimates are multiplied; 0 unless set.
  void set_light(size_t i, const Rgb& light);

  /// So many are computed at once.
  static constexpr int kLanes = 8;
  /// Room that estimates of n ends take.
  static size_t room(size_t n) { return (n + kLanes - 1) / kLanes * kLanes; }
  /// out[i]: luminance of what end i sends by `c`, one that has estimates, times its light; beyond
  /// them, up to room(), anything.
  void estimate(const End& c, double* out) const;
  /// The same of those that are chosen; there must be one end at least.
  void estimate(const End& c, const std::array<int, kLanes>& chosen, double* out) const;

 private:
  struct Columns {
    std::array<const double*, kPlaces> place{};
    std::array<const float*, kColours> colour{};
  };
  struct Gloss;
  void make_place();

  size_t size_ = 0;
  bool glossy_ = false;  // some of them
  Columns columns_;      // of what follows
  std::array<std::vector<double>, kPlaces> place_;
  std::array<std::vector<float>, kColours> colour_;
};

}  // namespace tdpt
