// Next events at the few big flat emitters that rooms have: windows, panels, a lamp's face. Which
// of them, and where on it, by what arrives at the shaded point unless something is between.
//
// Method: each emitting rectangle is laid out over
//   a = c(s/H),  b = c(t/H),  c(v) = v / (1 + |v|) in (-1, 1),
// with s, t from the foot of the point's perpendicular on its plane. That is about as even as solid
// angle is and takes no arc tangent (window_sky.h does so with the sky). What is left of the
// geometry term, R, is looked at in the four corners, and taken to be bilinear over (a, b) between.
//
// Y      luminance that a panel sends out (mean; no more than proportional)
// h, H   height of the point over the plane; the same, at least a share of the panel's size
// z      height of a corner over the horizon of the shading normal, 0 below it; where light goes
//        through the surface, on either side of it
// R      z h / d^4 per da db: what is common to all cos cos / d^2 of the panel
//   p_A(x_0 | x_1) = Y R(a,b) (da db / dA) / sum over the panels of Y integral R da db
//
// It is an estimate of cos cos / d^2, not a bound: 0 only where that is 0. Samples in exact
// proportion to it (Peters 2021) have 0.93 of its relMSE, and a picture takes twice the time:
// measured with next events alone in two furnished rooms.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "libcommon/scene/lights.h"
#include "tools/tdpt-render/path/light/vertex.h"

namespace tdpt {

class Panels {
 public:
  static constexpr size_t kMost = 8;
  /// One panel alone is worth its time where it is big [canonical area].
  static constexpr double kBig = 0.05;

  Panels() = default;
  /// None, unless all surfaces that emit are rectangles of two triangles, one big one or a few.
  Panels(const Scene& scene, const Lights& lights);

  bool empty() const { return all_.empty(); }

  struct Panel {
    Vec3d corner, x, y, normal;  ///< x, y: unit, along the edges; normal: unit, front side
    double length_x, length_y, least_height;
    double luminance;
    bool both_sides;
    std::array<uint32_t, 2> triangle;  ///< above the diagonal (x, then y), below it
    /// Of their vertices: corners of the panel, 0 at `corner`, 1, 2, 3 around from x to y.
    std::array<std::array<uint8_t, 3>, 2> corners;
  };
  const std::vector<Panel>& all() const { return all_; }

  /// Of the panel that has `triangle`.
  bool both_sides(uint32_t triangle) const { return find(triangle)->both_sides; }
  /// Sum of what all send to `v`, which has looked out.
  double sent(const Vertex& v) const;
  /// A place on a panel, with p_A and without its side; false when none sends anything. Three
  /// numbers in [0,1). `sent`: becomes that of v.
  bool sample(const Vertex& v, double pick, double u, double w, double& sent,
              Lights::Point& point) const;
  /// p_A of a place on one.
  double pdf_A(const Vertex& v, double sent, uint32_t triangle, const Vec3d& position) const;

 private:
  /// A panel from a point.
  struct View {
    double H, s, t;           ///< s, t of `corner`
    double a0, a1, b0, b1;    ///< it is [a0,a1] x [b0,b1]
    std::array<double, 4> R;  ///< of (a0,b0), (a1,b0), (a0,b1), (a1,b1)
    double total;             ///< integral R da db; 0: nothing else is told
  };
  static void look(const Panel& panel, const Vertex& v, const Vec3d& up, View& view);

  /// Null: on none.
  const Panel* find(uint32_t triangle) const;

  std::vector<Panel> all_;
};

}  // namespace tdpt
