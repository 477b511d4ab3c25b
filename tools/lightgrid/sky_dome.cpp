#include "tools/lightgrid/sky_dome.h"

#include <algorithm>

#include "libcommon/scene/sky_bins.h"

namespace tdpt {

bool has_sky(const CutFile& cut) {
  return std::any_of(cut.patches.begin(), cut.patches.end(),
                     [](const Patch& p) { return p.is_sky(); });
}

void add_sky_dome(Scene& scene) {
  scene.dome = static_cast<uint32_t>(scene.triangles.size());
  const auto material = static_cast<uint32_t>(scene.materials.size());
  scene.materials.emplace_back();
  for (uint32_t bin = 0; bin < kSkyBins; ++bin) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const Vec3d& corner : sky_bin_corners(bin))
      scene.positions.push_back(Vec3f(corner) * kDomeRadius);
    scene.triangles.push_back({{first, first + 1, first + 2}, material});
  }
  const auto follow = [](auto& attributes, size_t count) {
    if (!attributes.empty()) attributes.resize(count);
  };
  const size_t n = scene.positions.size();
  follow(scene.normals, n);
  follow(scene.tangents, n);
  for (auto& uv : scene.uv) follow(uv, n);
  follow(scene.colours, n);
  follow(scene.smooth, scene.triangles.size());
}

}  // namespace tdpt
