// KHR_lights_punctual and EXT_lights_ies. Internal to this room.
#pragma once
#include <map>
#include <memory>

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

bool holds_light(const Document& document, size_t node);

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Units of the file's lamps.
LampUnits lamp_units_of(const Document& document);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
