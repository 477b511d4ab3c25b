// Panels of a scene: what its camera sees, and the plan of each storey as architects draw it. What
// is cut at eye height is dark, what lies below is seen from above. x runs to the right, z down.
#pragma once
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "libcommon/draw/drawing.h"
#include "libcommon/draw/storeys.h"
#include "libcommon/formats/cut.h"

namespace tdpt::draw {

/// Colour of a surface at `place` (canonical) on face 2 * triangle + side.
using Colouring = std::function<Ink(uint32_t face, const Vec3d& place)>;

/// The plans are those of the storeys with the camera and with many of `places` [metres], upwards;
/// of a scene without storeys there is one, at the mean height of the places, or the camera's.
/// `with_camera`: the camera's view stands before them. Lamps are kLamp.
std::vector<Panel> scene_panels(const Scene& scene, const Camera& camera,
                                const std::vector<Vec3d>& places, const Colouring& colour,
                                bool with_camera);

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

/// A square just in front of a patch's surface, so that scene and patches can be shown together.
void add_patch(Shape& shape, const PatchGrid& grid, const Patch& patch, const Ink& c);

}  // namespace tdpt::draw
