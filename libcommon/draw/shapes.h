// Points, lines and triangles in space in plain colours: what previews show, and what --debug-glb
// writes for any glTF viewer.
#pragma once
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/draw/canvas.h"

namespace tdpt::draw {

struct Paint {
  Ink ink;
  float alpha;
  // NOLINTNEXTLINE(google-explicit-constructor): an ink is an opaque paint
  constexpr Paint(const Ink& i, float a = 1) : ink(i), alpha(a) {}
  bool operator==(const Paint& p) const { return ink == p.ink && alpha == p.alpha; }
};

/// Of one primitive type; every corners() consecutive vertices form a primitive.
struct Shape {
  enum class Kind { points, lines, triangles };
  std::string name{};
  Kind kind = Kind::triangles;
  double size = 1;                 ///< radius of points, width of lines [pixels]; not in a .glb
  bool through = false;            ///< not paler behind a surface
  std::vector<Vec3d> positions{};  ///< metres
  std::vector<Paint> paints{};     ///< per position

  size_t corners() const { return static_cast<size_t>(kind) + 1; }
  void point(const Vec3d& at, const Paint& p);
  void line(const Vec3d& a, const Vec3d& b, const Paint& at_a, const Paint& at_b);
  void line(const Vec3d& a, const Vec3d& b, const Paint& p) { line(a, b, p, p); }
  /// From `from` along `way`, its head in the directions +-x and +-y (unit).
  void arrow(const Vec3d& from, const Vec3d& way, const Vec3d& x, const Vec3d& y, const Paint& p);
  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Paint& p);
  /// A square around `centre` with unit `normal`, counter-clockwise seen from the normal's side.
  void square(const Vec3d& centre, const Vec3d& normal, double side, const Paint& p);
  void cube(const Vec3d& centre, double side, const Paint& p);
};

/// glTF; empty shapes are left out. Materials are unlit and double-sided; they are translucent if
/// some alpha is below 1.
std::string debug_glb_bytes(const std::vector<Shape>& shapes, const Provenance& provenance);

}  // namespace tdpt::draw
