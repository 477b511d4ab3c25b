// From a place on a surface to the patch of the cut it belongs to, and back: random places on a
// patch.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/cut.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// A place on a surface with the unit normal of the side that faces the light's path; canonical.
struct SurfacePoint {
  Vec3d position, normal;
};

class PatchMap {
 public:
  /// Keeps references. Throws InputError when the cut names triangles the scene does not have.
  /// `cut_name` names the cut file in the message.
  PatchMap(const Scene& scene, const CutFile& cut, const std::string& cut_name);

  /// Region of the patch that holds the canonical `position` on face 2*triangle + side; nothing
  /// when no patch does (surface that no walk has reached).
  std::optional<uint32_t> region_at(uint32_t face, const Vec3d& position) const;

 private:
  using Place = std::pair<int, std::array<int32_t, 3>>;  // level and cell
  Place place(uint32_t patch) const {
    return {cut_.patches[patch].level, cut_.patches[patch].cell};
  }

  const Scene& scene_;
  const CutFile& cut_;
  std::vector<int> levels_;  // that occur, finest first
  // Patches of face f at first_[f] .. first_[f + 1]: by level, then by cell.
  std::vector<uint32_t> first_, patches_;
};

/// The part of a patch's faces within its cell, as triangles to draw points from.
class PatchSurface {
 public:
  PatchSurface(const Scene& scene, const PatchGrid& grid, const Patch& patch);

  bool empty() const { return pieces_.empty(); }
  double area() const { return area_; }  ///< canonical
  /// Uniform by area; 3 dimensions of `rng`. Must not be empty.
  SurfacePoint sample(Rng& rng) const;

 private:
  struct Piece {
    Vec3d a, b, c, normal;
  };
  std::vector<Piece> pieces_;
  AliasTable table_;
  double area_ = 0;
};

}  // namespace tdpt
