// Light grids (.vdb): where light between pivot patches passes through the air.
// Written by lightgrid; read by portalfit. OpenVDB stays behind this header.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// One sampled line of light that joins the two sides of the cut, metres; it runs from `light`
/// (on the source side's surface) to `camera` (on the sink side's).
struct LightLine {
  Vec3d light, camera;
};

/// Dense box of cubic voxels. Index (i,j,k) is at [i + dim[0] * (j + dim[1] * k)]; voxel (i,j,k)
/// spans origin + voxel * [i, i+1) x [j, j+1) x [k, k+1).
struct LightGrid {
  Vec3d origin{};    ///< metres
  double voxel = 1;  ///< side in metres
  std::array<int, 3> dim{};
  std::vector<float> count;      ///< segments through each air voxel; 0 outside the air
  std::vector<uint8_t> air;      ///< 1: free of geometry
  std::vector<Vec3f> direction;  ///< sum of unit directions towards the camera / count
  std::vector<LightLine> lines;  ///< a sample of the segments themselves
  bool bottleneck = true;
  std::string reason;            ///< why not
  double flux_share = 1;         ///< share of drawn segments that were kept, see lightgrid(1)
  std::string scene_hash;
  Provenance provenance;
  std::string hash;              ///< content hash of the file read

  size_t index(int i, int j, int k) const {
    return static_cast<size_t>(i) +
           static_cast<size_t>(dim[0]) *
               (static_cast<size_t>(j) + static_cast<size_t>(dim[1]) * static_cast<size_t>(k));
  }
};

LightGrid read_light_grid(const std::string& path);
std::string light_grid_bytes(const LightGrid& grid);

}  // namespace tdpt
