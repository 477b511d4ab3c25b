// Glass balls without glass: surfaces that transmit and enclose a space, in a material without
// KHR_materials_volume, for which the format has a thin sheet where a solid is meant as a rule.
// Internal to this room.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

class Bubbles {
 public:
  /// A mesh as it is placed: three `corners` for each triangle, into its vertices, which begin at
  /// `first` in `world` [m].
  void look_at(const Material& material, const std::vector<uint32_t>& corners,
               const std::vector<Vec3d>& world, uint32_t first);
  /// A sentence, once for all; empty where there is none.
  std::string warning() const;

 private:
  size_t count_ = 0;
  std::string name_;  ///< of the first one's material
};

}  // namespace tdpt::gltf
