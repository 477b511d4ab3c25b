// EXT_lights_area (a draft: KhronosGroup/glTF, pull request 2525). Internal to this room.
#pragma once
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Vertices and triangles of the node's area light; zeros if it holds none.
struct Polygon {
  size_t vertices = 0, triangles = 0;
};
Polygon polygon_of_light(const Document& document, size_t node);

/// Adds area lights to the scene as black triangles that emit from their front, which faces -Z of
/// the node: a rectangle is two, a disk a polygon of 64 corners and of the disk's area. Each light
/// has a material of its own, whose emission is in the units of the file [take_lamps_as()].
class AreaLightReader {
 public:
  AreaLightReader(const Document& document, Scene& scene) : d_(document), scene_(scene) {}

  /// Adds the node's light to the scene, its vertices [m] to `world`. Adds nothing if the node
  /// holds none, a dark one, or one whose direction its transform destroys; faint ones and the last
  /// are counted.
  void add(const PlacedNode& node, std::vector<Vec3d>& world);
  size_t flat() const { return flat_; }
  /// Lights left out because they emit next to nothing.
  size_t faint() const { return faint_; }

 private:
  void add_corners(const PlacedNode& node, const std::vector<Vec3d>& corners,
                   std::vector<Vec3d>& world);

  const Document& d_;
  Scene& scene_;
  size_t flat_ = 0, faint_ = 0;
};

}  // namespace tdpt::gltf
