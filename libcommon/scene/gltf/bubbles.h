// Detects glass objects modelled as thin sheets: closed transmitting surfaces whose material lacks
// KHR_materials_volume. The format defines these as bubbles; usually a solid was meant. Internal to
// this room.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

class Bubbles {
 public:
  /// Examines a placed mesh: three `corners` per triangle, into its vertices, which begin at
  /// `first` in `world` [m].
  void look_at(const Material& material, const std::vector<uint32_t>& corners,
               const std::vector<Vec3d>& world, uint32_t first);
  /// One sentence for all of them; empty if none was found.
  std::string warning() const;

 private:
  size_t count_ = 0;
  std::string name_;  ///< name of the first one's material
};

}  // namespace tdpt::gltf
