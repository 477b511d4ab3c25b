// From places on surfaces to patches: a patch is one side of one surface component within one cell
// of a grid. Cells that were split are looked up one level deeper (4 cells per axis).
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "libcommon/formats/cut.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// face = 2 * triangle + side, side 0: front.
inline constexpr uint32_t kNoFace = UINT32_MAX;
inline constexpr uint32_t kNoPatch = UINT32_MAX;

struct PatchKey {
  std::array<int32_t, 3> cell{};
  int32_t level = 0;
  uint32_t piece = 0;  ///< 2 * component + side
  bool operator==(const PatchKey&) const = default;

  PatchKey parent() const { return {{cell[0] >> 2, cell[1] >> 2, cell[2] >> 2}, level - 1, piece}; }
};

class PatchMap {
 public:
  PatchMap() = default;
  static constexpr uint32_t kSplit = UINT32_MAX - 1;

  /// `component` of each triangle. Keeps a pointer to `scene`.
  PatchMap(const Scene& scene, const PatchGrid& grid, std::vector<uint32_t> component)
      : scene_(&scene),
        grid_(grid),
        component_(std::make_shared<const std::vector<uint32_t>>(std::move(component))) {}

  const PatchGrid& grid() const { return grid_; }
  const Scene& scene() const { return *scene_; }
  uint32_t piece(uint32_t face) const { return 2 * (*component_)[face / 2] + (face & 1); }

  /// Cell of a place (canonical) at a level.
  std::array<int32_t, 3> cell(const Vec3d& canonical, int level) const;

  /// Patch at a place on `face`; kNoPatch where none exists.
  uint32_t find(uint32_t face, const Vec3d& canonical) const;
  /// The same, made when it does not exist yet.
  uint32_t find_or_add(uint32_t face, const Vec3d& canonical);
  /// Adds a patch under `key`, and the splits that lead to it.
  uint32_t add(const PatchKey& key);

  /// Patch under `key`, kSplit where its cell was split, kNoPatch where there is none.
  uint32_t lookup(const PatchKey& key) const {
    const auto found = entry_.find(key);
    return found == entry_.end() ? kNoPatch : found->second;
  }
  /// Whether any patch lies on this piece.
  bool touched(uint32_t piece) const {
    return piece < piece_touched_.size() && piece_touched_[piece];
  }

  uint32_t size() const { return static_cast<uint32_t>(keys_.size()); }
  const std::vector<PatchKey>& keys() const { return keys_; }

  /// Drops the patches that are not kept and numbers the others anew, in their order.
  void keep(const std::vector<uint8_t>& kept);

  /// The map with the cells of the chosen patches split and no patches yet: they come back as
  /// places are found in them.
  PatchMap split(const std::vector<uint8_t>& chosen) const;

 private:
  struct KeyHash {
    size_t operator()(const PatchKey& k) const {
      uint64_t h = mix64(k.piece + (uint64_t{static_cast<uint32_t>(k.level)} << 32));
      for (int32_t c : k.cell) h = mix64(h + static_cast<uint32_t>(c));
      return h;
    }
  };

  PatchKey start(uint32_t face, const Vec3d& canonical) const {
    return {cell(canonical, 0), 0, piece(face)};
  }

  const Scene* scene_ = nullptr;
  PatchGrid grid_;
  std::shared_ptr<const std::vector<uint32_t>> component_;
  std::unordered_map<PatchKey, uint32_t, KeyHash> entry_;
  std::vector<PatchKey> keys_;
  std::vector<uint8_t> piece_touched_;
};

/// Grid for a scene: cells of (diagonal of the bounding box) / 24, in metres.
PatchGrid grid_for(const Scene& scene);

}  // namespace tdpt
