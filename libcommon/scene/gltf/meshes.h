// Converts meshes of placed nodes to world-space triangles. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/materials.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Which materials the surfaces of visible meshes use.
std::vector<bool> used_materials(const Document& document, const PlacedNodes& nodes);

/// What was read of the meshes besides their triangles and attributes.
struct Meshes {
  std::vector<Vec3d> world;  ///< vertices [m]
  double grain = 0;          ///< largest rounding error of a vertex [m]
  bool unnamed_material = false;
};

/// Adds the meshes of all visible nodes to the scene. Makes room for the vertices of area lights,
/// too. A scene whose instances would fill the memory is refused before any vertex is read. `uses`:
/// per material of the file, followed by the default for surfaces without one.
Meshes read_meshes(const Document& document, const PlacedNodes& nodes, Scene& scene,
                   std::vector<MaterialUse>& uses, Notes& notes);

}  // namespace tdpt::gltf
