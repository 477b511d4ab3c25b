// Maps points on surfaces to patches: a patch is one side of one surface component within one cell
// of a grid, whatever the tessellation.
//
// Method: a sparse tree of cells in a hash table, with 4 children per axis; the search descends a
// level where a cell was split.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libcommon/formats/cut.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// face = 2 * triangle + side, side 0: front.
inline constexpr uint32_t kNoFace = UINT32_MAX;
inline constexpr uint32_t kNoPatch = UINT32_MAX;
/// Piece of the patches that are bins of the sky; their cell is {bin, 0, 0}.
inline constexpr uint32_t kSkyPiece = UINT32_MAX;

struct WalkHit {
  uint32_t face;   ///< or one of the end marks after a walk's last hit [walks.h]
  Vec3f position;  ///< canonical
};

/// The triangle of a face; its normal is that of the side.
inline TriangleShape facing(const Scene& scene, uint32_t face) {
  TriangleShape shape = shape_of(scene, face / 2);
  if (face & 1) shape.normal = -shape.normal;
  return shape;
}

struct PatchKey {
  std::array<int32_t, 3> cell{};
  int32_t level = 0;
  uint32_t piece = 0;  ///< 2 * component + side
  bool operator==(const PatchKey& k) const {
    return cell[0] == k.cell[0] && cell[1] == k.cell[1] && cell[2] == k.cell[2] &&
           level == k.level && piece == k.piece;
  }

  PatchKey parent() const { return {{cell[0] >> 2, cell[1] >> 2, cell[2] >> 2}, level - 1, piece}; }
};

/// Numbers by key, kNoPatch where there is none: a hash table with open addressing.
class PatchTable {
 public:
  struct Entry {
    PatchKey key{};
    uint32_t number = kNoPatch;
  };
  uint32_t at(const PatchKey& key) const { return entries_[place_of(key)].number; }
  /// `number`: not kNoPatch.
  void set(const PatchKey& key, uint32_t number);
  /// Those with number kNoPatch are free.
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  size_t place_of(const PatchKey& key) const {
    const auto word = [](int32_t low, uint32_t high) {
      return static_cast<uint32_t>(low) | uint64_t{high} << 32;
    };
    const uint64_t h = mix64(word(key.cell[0], static_cast<uint32_t>(key.cell[1])));
    size_t i = mix64(h + word(key.cell[2], key.piece) + (static_cast<uint64_t>(key.level) << 28));
    for (;; ++i) {
      const Entry& entry = entries_[i &= entries_.size() - 1];
      if (entry.number == kNoPatch || entry.key == key) return i;
    }
  }

  std::vector<Entry> entries_ = std::vector<Entry>(64);  // a power of two
  size_t used_ = 0;
};

/// Component of each triangle: triangles connected by edges (half-edge structure over vertices at
/// the same position) whose normals fall into one bin. Bins are the cells of (2n rounded), so flat
/// walls stay whole and curved surfaces split into pieces that face roughly one way. Triangles that
/// fit into no manifold are components of their own. Numbers are dense from 0.
std::vector<uint32_t> surface_components(const Scene& scene);

/// A region where cells are at most as large as those of `level`.
struct FineRegion {
  Vec3d low{}, high{};  ///< metres
  int level = 0;
};

class PatchMap {
 public:
  PatchMap() = default;
  static constexpr uint32_t kSplit = UINT32_MAX - 1;

  /// `component`: per triangle. Keeps a pointer to `scene`.
  PatchMap(const Scene& scene, const PatchGrid& grid, std::vector<uint32_t> component,
           const FineRegion& fine = {});

  const PatchGrid& grid() const { return grid_; }
  const Scene& scene() const { return *scene_; }
  /// Level of the unsplit cells of the fine region.
  int fine_level() const { return fine_level_; }
  uint32_t piece(uint32_t face) const { return 2 * (*component_)[face / 2] + (face & 1); }

  /// Patch at a point on `face`; kNoPatch if none exists.
  uint32_t find(uint32_t face, const Vec3d& canonical) const;
  /// The same, but adds the patch if it does not exist yet.
  uint32_t find_or_add(uint32_t face, const Vec3d& canonical);

  /// Equivalent to find_or_add() of all places on faces in this order, but with parallel look-ups.
  /// The patch of each, kNoPatch where it is on no face.
  std::vector<uint32_t> add_all(const std::vector<WalkHit>& places);

  /// Adds a patch under `key`, and the splits above it.
  uint32_t add(const PatchKey& key);

  /// The patch of a bin of the sky (sky_bins.h); kNoPatch before it is added.
  uint32_t find_sky(uint32_t bin) const { return entry_.at(sky_key(bin)); }
  uint32_t add_sky(uint32_t bin);
  bool has_sky() const { return sky_; }
  bool is_sky(uint32_t patch) const { return keys_[patch].piece == kSkyPiece; }
  uint32_t bin_of(uint32_t patch) const { return static_cast<uint32_t>(keys_[patch].cell[0]); }

  /// Patch under `key`, kSplit if its cell was split, kNoPatch if there is none.
  uint32_t lookup(const PatchKey& key) const { return always_split(key) ? kSplit : entry_.at(key); }
  /// Whether the parent cell was split because a patch straddled an opening.
  bool below_split(const PatchKey& key) const {
    return key.level > 0 && !always_split(key.parent());
  }
  /// Range of base cells, `low` to `high`, outside of which no patch lies and nothing was split.
  struct Extent {
    std::array<int32_t, 3> low{INT32_MAX, INT32_MAX, INT32_MAX},
        high{INT32_MIN, INT32_MIN, INT32_MIN};
  };
  Extent extent() const;
  /// Whether this piece has any patch.
  bool touched(uint32_t piece) const {
    return piece < piece_touched_.size() && piece_touched_[piece];
  }

  uint32_t size() const { return static_cast<uint32_t>(keys_.size()); }
  const std::vector<PatchKey>& keys() const { return keys_; }

  /// Removes all other patches and renumbers the kept ones in their order. The new number of each,
  /// kNoPatch if it was removed.
  std::vector<uint32_t> keep(const std::vector<uint8_t>& kept);

  /// The map with the cells of the chosen patches split and without patches: these are added again
  /// as points are found in them.
  PatchMap split(const std::vector<uint8_t>& chosen) const;

 private:
  static PatchKey sky_key(uint32_t bin) {
    return {{static_cast<int32_t>(bin), 0, 0}, 0, kSkyPiece};
  }
  /// In base cells from the origin of the grid.
  Vec3d in_grid(const Vec3d& canonical) const {
    return (scene_->frame.to_metres(canonical) - grid_.origin) / grid_.base_cell;
  }
  /// Whether a cell is larger than those of the fine region that it overlaps.
  bool always_split(const PatchKey& key) const;
  /// The key at which the search for a patch ends, and its value.
  std::pair<PatchKey, uint32_t> search(uint32_t face, const Vec3d& canonical) const;

  const Scene* scene_ = nullptr;
  PatchGrid grid_;
  int fine_level_ = 0;
  Vec3d fine_low_{}, fine_high_{};  // in base cells from the origin of the grid
  std::shared_ptr<const std::vector<uint32_t>> component_;
  PatchTable entry_;  // a patch, or kSplit
  std::vector<PatchKey> keys_;
  std::vector<uint8_t> piece_touched_;
  bool sky_ = false;  // whether the sky has patches
};

}  // namespace tdpt
