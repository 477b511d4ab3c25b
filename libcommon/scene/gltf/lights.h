// KHR_lights_punctual and EXT_lights_ies, and what EXT_lights_area has in common with them.
// Internal to this room.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Adds the lights of nodes to the scene, still in metres: position [m], intensity of points and
/// spots [W/sr]. Profiles in files beside the scene are listed in scene.files and change its hash.
class LightReader {
 public:
  LightReader(const Document& document, Scene& scene) : d_(document), scene_(scene) {}

  /// Adds nothing if the node holds no light, a light without intensity, or one whose direction its
  /// transform destroys; the last two are counted.
  void add(const PlacedNode& node);
  size_t flat() const { return flat_; }

 private:
  void add_punctual(const PlacedNode& node, const nlohmann::json& extension);
  void add_luminaire(const PlacedNode& node, const nlohmann::json& extension);
  std::shared_ptr<const LightProfile> profile(size_t index);

  const Document& d_;
  Scene& scene_;
  size_t flat_ = 0;
  uint64_t bytes_of_profiles_ = 0;
  std::map<std::string, std::shared_ptr<const LightProfile>> profiles_;  // by their source
};

/// Of any of the three extensions.
bool holds_light(const Document& document, size_t node);

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Units of the file's lamps. `area_lights`: whether its scene has any.
LampUnits lamp_units_of(const Document& document, bool area_lights);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

// EXT_lights_area (a draft: KhronosGroup/glTF, pull request 2525).

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
