// Which triangles belong to one piece of surface.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt {

/// Component of each triangle: triangles joined by edges (half-edge connectivity over vertices at
/// the same place) whose normals fall into one bin. Bins are the cells of (2n rounded), so flat
/// walls are whole and curved surfaces fall into pieces that face about one way. Triangles that no
/// manifold can hold are components of their own. Numbers are dense from 0.
std::vector<uint32_t> surface_components(const Scene& scene);

}  // namespace tdpt
