// Pictures of a light grid: its counts along the three axes, as in the paper's Fig. 3.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/drawing.h"
#include "libcommon/formats/light_grid.h"

namespace tdpt {

/// A grid projected along `axis`: pixel (u, v) represents a row of voxels; u is along the next
/// axis, v along the one after it (axis 0: u = y, v = z).
struct FlatGrid {
  int width = 0, height = 0;
  std::vector<float> most;   ///< largest count in the row; at [u + width * v]
  std::vector<float> solid;  ///< share of the row that is not air
};
FlatGrid flattened(const LightGrid& grid, int axis);

/// The three projections, arranged as the views of a technical drawing. `name`: of the scene.
draw::Drawing grid_preview(const LightGrid& grid, const std::string& name);
/// glTF: the fullest voxels as cubes, others as points, and some lines of light.
std::string grid_debug_glb(const LightGrid& grid);

}  // namespace tdpt
