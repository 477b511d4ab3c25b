// KHR_lights_punctual and EXT_lights_ies, and what EXT_lights_area has in common with them.
// Internal to this room.
#pragma once
#include <map>
#include <memory>
#include <optional>

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

constexpr const char* kAreaLights = "EXT_lights_area";

/// Of any of the three extensions.
bool holds_light(const Document& document, size_t node);

/// The light's name, else its node's.
std::string name_of_light(const Document& document, const nlohmann::json& light, size_t node);

/// `owner`'s color, white if it has none.
Vec3d colour_of_light(const nlohmann::json& owner);

/// Throws InputError, naming `place`, if a component is above 1e30.
void check_intensity(const Document& document, const std::string& place, const Vec3d& intensity);

/// The map of a node without its scale, shear and mirroring: unit axes, orthogonal and
/// right-handed, Z that of the node. Empty if the node's map destroys its Z or leaves no plane.
std::optional<Affine> axes_of_light(const Affine& map);

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Units of the file's lamps. `area_lights`: whether its scene has any.
LampUnits lamp_units_of(const Document& document, bool area_lights);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
