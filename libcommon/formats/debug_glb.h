// glTF files for inspection in any viewer: points, lines and triangles in plain colours. Written by
// --debug-glb of each stage.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/cli/cli.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// One mesh of one primitive type; every `corners` consecutive vertices form a primitive (points 1,
/// lines 2, triangles 3).
struct DebugMesh {
  enum class Kind { points, lines, triangles };
  std::string name{};
  Kind kind = Kind::triangles;
  std::vector<Vec3d> positions{};                 ///< metres
  std::vector<std::array<uint8_t, 4>> colours{};  ///< per position; sRGB, alpha as a share of 255

  using Colour = std::array<uint8_t, 4>;
  void point(const Vec3d& at, const Colour& c);
  void line(const Vec3d& a, const Vec3d& b, const Colour& at_a, const Colour& at_b);
  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Colour& colour);
  /// A square around `centre` with unit `normal`, counter-clockwise seen from the normal's side.
  void square(const Vec3d& centre, const Vec3d& normal, double side, const Colour& c);
  void cube(const Vec3d& centre, double side, const Colour& c);
};

enum class DebugLines { edges, strips };

/// Empty meshes are left out. Lines are written as edges, which renderers do not show, or as thin
/// strips of triangles. Materials are unlit and double-sided; triangles are translucent if some
/// alpha is below 255.
std::string debug_glb_bytes(const std::vector<DebugMesh>& meshes, const Provenance& provenance,
                            DebugLines lines = DebugLines::edges);

/// --set debug-lines.
void declare_debug_lines(cli::Options& options, std::string& value);

DebugLines debug_lines(const std::string& value);

}  // namespace tdpt
