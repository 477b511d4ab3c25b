#include "libcommon/draw/patch_lookup.h"

#include <algorithm>
#include <cmath>

#include "libcommon/math/rng.h"

namespace tdpt::draw {

size_t PatchLookup::Hash::operator()(const Key& k) const {
  uint64_t h = mix64(k.face + (static_cast<uint64_t>(k.level) << 40));
  for (const int32_t c : k.cell) h = mix64(h ^ static_cast<uint32_t>(c));
  return h;
}

PatchLookup::PatchLookup(const Frame& frame, const PatchGrid& grid,
                         const std::vector<Patch>& patches)
    : frame_(frame), grid_(grid) {
  for (size_t i = 0; i < patches.size(); ++i) {
    const Patch& p = patches[i];
    if (std::find(levels_.begin(), levels_.end(), p.level) == levels_.end())
      levels_.push_back(p.level);
    for (const uint32_t face : p.faces)
      patch_.emplace(Key{face, p.level, p.cell}, static_cast<uint32_t>(i));
  }
  std::sort(levels_.rbegin(), levels_.rend());
}

std::optional<uint32_t> PatchLookup::at(uint32_t face, const Vec3d& place) const {
  const Vec3d metres = frame_.to_metres(place);
  for (const int level : levels_) {
    // Uses the same operations as ffgraph, so that rounding at borders agrees.
    const Vec3d q = (metres - grid_.origin) / grid_.base_cell;
    const double fine = std::ldexp(1.0, 2 * level);
    Key key{face, level, {}};
    for (int c = 0; c < 3; ++c)
      key.cell[static_cast<size_t>(c)] =
          static_cast<int32_t>(std::clamp(std::floor(q[c] * fine), -2147483648.0, 2147483647.0));
    if (const auto found = patch_.find(key); found != patch_.end()) return found->second;
  }
  return {};
}

}  // namespace tdpt::draw
