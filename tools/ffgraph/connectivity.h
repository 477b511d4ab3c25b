// Connected components of the surface.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt {

/// Component of each triangle: triangles connected by edges (half-edge structure over vertices at
/// the same position) whose normals fall into one bin. Bins are the cells of (2n rounded), so flat
/// walls stay whole and curved surfaces split into pieces that face roughly one way. Triangles that
/// fit into no manifold are components of their own. Numbers are dense from 0.
std::vector<uint32_t> surface_components(const Scene& scene);

}  // namespace tdpt
