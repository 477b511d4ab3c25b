#include "tools/ffgraph/patch_map.h"

#include <cmath>

namespace tdpt {

PatchGrid grid_for(const Scene& scene) {
  Vec3d low(1e300), high(-1e300);
  for (const Triangle& t : scene.triangles)
    for (uint32_t v : t.vertex) {
      low = min(low, Vec3d(scene.positions[v]));
      high = max(high, Vec3d(scene.positions[v]));
    }
  if (!(low.x <= high.x)) low = high = Vec3d{};
  PatchGrid grid;
  grid.base_cell = std::max(length(high - low), 1e-6) / 24 / scene.frame.scale;
  // Walls often lie on the bounding box: keep them off the faces of cells.
  grid.origin = scene.frame.to_metres(low) - Vec3d(0.3819, 0.3453, 0.4142) * grid.base_cell;
  return grid;
}

std::array<int32_t, 3> PatchMap::cell(const Vec3d& canonical, int level) const {
  const Vec3d q = (scene_->frame.to_metres(canonical) - grid_.origin) / grid_.base_cell;
  const double fine = std::ldexp(1.0, 2 * level);
  const auto index = [fine](double v) {
    return static_cast<int32_t>(std::clamp(std::floor(v * fine), -2147483648.0, 2147483647.0));
  };
  return {index(q.x), index(q.y), index(q.z)};
}

uint32_t PatchMap::find(uint32_t face, const Vec3d& canonical) const {
  PatchKey key = start(face, canonical);
  for (;;) {
    const auto found = entry_.find(key);
    if (found == entry_.end()) return kNoPatch;
    if (found->second != kSplit) return found->second;
    ++key.level;
    key.cell = cell(canonical, key.level);
  }
}

uint32_t PatchMap::find_or_add(uint32_t face, const Vec3d& canonical) {
  PatchKey key = start(face, canonical);
  for (;;) {
    const auto found = entry_.find(key);
    if (found == entry_.end()) return add(key);
    if (found->second != kSplit) return found->second;
    ++key.level;
    key.cell = cell(canonical, key.level);
  }
}

uint32_t PatchMap::add(const PatchKey& key) {
  const auto [entry, is_new] = entry_.try_emplace(key, size());
  if (!is_new) return entry->second;
  const uint32_t id = size();
  keys_.push_back(key);
  PatchKey up = key;
  while (up.level > 0) {
    up = up.parent();
    entry_[up] = kSplit;
  }
  if (key.piece >= piece_touched_.size()) piece_touched_.resize(key.piece + 1, 0);
  piece_touched_[key.piece] = 1;
  return id;
}

void PatchMap::keep(const std::vector<uint8_t>& kept) {
  std::vector<PatchKey> keys;
  for (uint32_t i = 0; i < size(); ++i) {
    if (!kept[i]) {
      entry_.erase(keys_[i]);
      continue;
    }
    entry_[keys_[i]] = static_cast<uint32_t>(keys.size());
    keys.push_back(keys_[i]);
  }
  keys_ = std::move(keys);
}

PatchMap PatchMap::split(const std::vector<uint8_t>& chosen) const {
  PatchMap finer = *this;
  finer.entry_.clear();
  finer.keys_.clear();
  finer.piece_touched_.clear();
  for (const auto& [key, value] : entry_)
    if (value == kSplit || chosen[value]) finer.entry_.emplace(key, kSplit);
  return finer;
}

}  // namespace tdpt
