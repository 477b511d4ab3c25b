// KHR_lights_punctual and EXT_lights_ies. Internal to this room.
#pragma once
#include <map>
#include <memory>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Adds the lights that nodes hold to the scene, in metres as yet: position [m], intensity of
/// points and spots [W/sr]. Profiles in files beside the scene are named in scene.files and change
/// its hash.
class LightReader {
 public:
  LightReader(const Document& document, Scene& scene) : d_(document), scene_(scene) {}

  /// Nothing where it holds none, or one without intensity, or where its transform leaves a light
  /// that has a direction none: such are counted.
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
  std::map<std::string, std::shared_ptr<const LightProfile>> profiles_;  // by where it stands
};

/// asset.generator; empty: not told.
std::string generator_of(const Document& document);

/// What the numbers of the file's lamps stand for.
LampUnits lamp_units_of(const Document& document);

/// Brings a light to the canonical frame. Throws InputError when its intensity is too large or too
/// small for single precision there.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
