// Finds the patch that a point on a surface belongs to.
#pragma once
#include <optional>
#include <unordered_map>

#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"

namespace tdpt::draw {

class PatchLookup {
 public:
  PatchLookup(const Frame& frame, const PatchGrid& grid, const std::vector<Patch>& patches);

  /// Index of the patch that contains canonical `place` on face 2 * triangle + side; empty if there
  /// is none (no walk has reached this surface).
  std::optional<uint32_t> at(uint32_t face, const Vec3d& place) const;

 private:
  struct Key {
    uint32_t face;
    int level;
    std::array<int32_t, 3> cell;
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    size_t operator()(const Key& k) const;
  };

  Frame frame_;
  PatchGrid grid_;
  std::vector<int> levels_;  // levels in use, finest first
  std::unordered_map<Key, uint32_t, Hash> patch_;
};

}  // namespace tdpt::draw
