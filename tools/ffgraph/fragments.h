// The surface of patches: each triangle clipped to the cells it crosses.
#pragma once
#include <vector>

#include "libcommon/math/rng.h"
#include "tools/ffgraph/patch_map.h"

namespace tdpt {

class Fragments {
 public:
  struct Fragment {
    uint32_t patch, face;
    double area;     ///< canonical
    Vec3d centroid;  ///< canonical
  };

  explicit Fragments(const PatchMap& patches);
  /// First adds all cells of split patches that contain a piece of their surface: what a walk
  /// touched remains complete when it is split.
  static Fragments with_all_of_split(PatchMap& patches);

  /// Ordered by patch, then by face.
  const std::vector<Fragment>& all() const { return fragments_; }

  /// Renumbers the patches as PatchMap::keep does.
  void keep(const std::vector<uint8_t>& kept);

  struct Point {
    uint32_t patch;
    Vec3d position, normal;  ///< canonical; on the facing side
  };
  /// Uniform by area on fragment `f`: uses 3 dimensions of `rng`.
  Point sample(uint32_t f, Rng& rng) const;

 private:
  struct Part;
  struct Walker;
  Fragments(const PatchMap& patches, PatchMap* grow);

  const PatchMap& patches_;
  std::vector<Fragment> fragments_;
};

}  // namespace tdpt
