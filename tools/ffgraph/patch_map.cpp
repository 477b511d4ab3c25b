#include "tools/ffgraph/patch_map.h"

#include <cmath>

namespace tdpt {

namespace {

// `q`: in base cells.
std::array<int32_t, 3> cell_at(const Vec3d& q, int level) {
  const auto fine = static_cast<double>(uint64_t{1} << 2 * level);
  const auto index = [fine](double v) {
    const double bounded = std::clamp(v * fine, -2147483648.0, 2147483647.0);
    const auto i = static_cast<int32_t>(bounded);  // towards zero; std::floor is a library call
    return i - (static_cast<double>(i) > bounded ? 1 : 0);
  };
  return {index(q.x), index(q.y), index(q.z)};
}

}  // namespace

uint32_t& PatchTable::operator[](const PatchKey& key) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<Slot> old(std::max<size_t>(64, 2 * slots_.size()), {{}, kNoPatch});
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.value != kNoPatch) slots_[slot_of(s.key)] = s;
  }
  Slot& slot = slots_[slot_of(key)];
  if (slot.value == kNoPatch) {
    slot.key = key;
    ++size_;
  }
  return slot.value;
}

std::array<int32_t, 3> PatchMap::cell(const Vec3d& canonical, int level) const {
  return cell_at(in_grid(canonical), level);
}

PatchMap::PatchMap(const Scene& scene, const PatchGrid& grid, std::vector<uint32_t> component,
                   const FineRegion& fine)
    : scene_(&scene),
      grid_(grid),
      fine_level_(fine.level),
      fine_low_((fine.low - grid.origin) / grid.base_cell),
      fine_high_((fine.high - grid.origin) / grid.base_cell),
      component_(std::make_shared<const std::vector<uint32_t>>(std::move(component))) {}

PatchMap::Extent PatchMap::extent() const {
  Extent extent;
  entry_.each([&](const PatchKey& key, uint32_t) {
    if (key.piece == kSkyPiece) return;
    for (size_t k = 0; k < 3; ++k) {
      const int32_t base = key.cell[k] >> (2 * key.level);
      extent.low[k] = std::min(extent.low[k], base);
      extent.high[k] = std::max(extent.high[k], base);
    }
  });
  return extent;
}

bool PatchMap::always_split(const PatchKey& key) const {
  if (key.level >= fine_level_) return false;
  const double size = std::ldexp(1.0, -2 * key.level);
  for (int axis = 0; axis < 3; ++axis) {
    const double low = key.cell[static_cast<size_t>(axis)] * size;
    if (low > fine_high_[axis] || low + size < fine_low_[axis]) return false;
  }
  return true;
}

std::pair<PatchKey, uint32_t> PatchMap::search(uint32_t face, const Vec3d& canonical) const {
  const Vec3d q = in_grid(canonical);
  PatchKey key{cell_at(q, 0), 0, piece(face)};
  for (;;) {
    const uint32_t found = lookup(key);
    if (found != kSplit) return {key, found};
    ++key.level;
    key.cell = cell_at(q, key.level);
  }
}

uint32_t PatchMap::find(uint32_t face, const Vec3d& canonical) const {
  return search(face, canonical).second;
}

uint32_t PatchMap::find_or_add(uint32_t face, const Vec3d& canonical) {
  const auto [key, found] = search(face, canonical);
  return found == kNoPatch ? add(key) : found;
}

uint32_t PatchMap::add(const PatchKey& key) {
  uint32_t& entry = entry_[key];
  if (entry != kNoPatch) return entry;
  const uint32_t id = entry = size();
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

uint32_t PatchMap::add_sky(uint32_t bin) {
  uint32_t& entry = entry_[sky_key(bin)];
  if (entry != kNoPatch) return entry;
  keys_.push_back(sky_key(bin));
  sky_ = true;
  return entry = size() - 1;
}

void PatchMap::keep(const std::vector<uint8_t>& kept) {
  PatchTable entry;
  std::vector<PatchKey> keys;
  entry_.each([&](const PatchKey& key, uint32_t value) {
    if (value == kSplit) entry[key] = kSplit;
  });
  for (uint32_t i = 0; i < size(); ++i) {
    if (!kept[i]) continue;
    entry[keys_[i]] = static_cast<uint32_t>(keys.size());
    keys.push_back(keys_[i]);
  }
  entry_ = std::move(entry);
  keys_ = std::move(keys);
}

PatchMap PatchMap::split(const std::vector<uint8_t>& chosen) const {
  PatchMap finer = *this;
  finer.entry_.clear();
  finer.keys_.clear();
  finer.piece_touched_.clear();
  entry_.each([&](const PatchKey& key, uint32_t value) {
    if (value == kSplit || chosen[value]) finer.entry_[key] = kSplit;
  });
  return finer;
}

}  // namespace tdpt
