// KHR_lights_punctual, EXT_lights_ies and EXT_lights_area (a draft: KhronosGroup/glTF, pull request
// 2525). Internal to this room.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Upper bound on the vertices and on the triangles of an area light.
constexpr size_t kMostOfAreaLight = 65;

/// Adds the lights of nodes to the scene. A light that emits nothing is passed over.
class LightReader {
 public:
  /// Reads all lights of the file, whether a node holds them or not. Throws InputError.
  LightReader(const Document& document, Scene& scene, Notes& notes);

  /// Adds the node's punctual light and luminaire, still in metres: position [m], intensity of
  /// points and spots [W/sr]. Profiles in files beside the scene are listed in scene.files and
  /// change its hash.
  void add(const PlacedNode& node);

  /// Adds the node's area light as black triangles that emit from their front, which faces -Z of
  /// the node, and its vertices [m] to `world`: a rectangle is two, a disk a polygon of 64 corners
  /// and of the disk's area. Each light has a material of its own, whose emission is in the units
  /// of the file [take_lamps_as()].
  void add_area_light(const PlacedNode& node, std::vector<Vec3d>& world);

  /// Units of the file's lamps, once all are added.
  LampUnits units() const;

 private:
  struct Lamp {
    PunctualLight light;  ///< but for intensity and place
    double number = 0;    ///< its intensity in the file
    Vec3d intensity;      ///< times its color
  };
  struct Profile {
    std::string name, uri;
    size_t view = kNone;  ///< kNone: the uri counts
    std::shared_ptr<const LightProfile> read;
  };
  struct AreaLamp {
    std::string name;
    Vec3d radiance;
    double size = 1, aspect = 1;
    bool disk = false;
  };
  static Lamp read_lamp(const Value& light);
  static Profile read_profile(const Value& light);
  static AreaLamp read_area_lamp(const Value& light);
  void add_lamp(const PlacedNode& node, const Lamp& lamp);
  void add_luminaire(const PlacedNode& node, const Luminaire& luminaire);
  std::shared_ptr<const LightProfile> profile(size_t index);

  const Document& d_;
  Scene& scene_;
  Notes& notes_;
  std::vector<Lamp> lamps_;
  std::vector<Profile> profiles_;
  std::vector<AreaLamp> area_lamps_;
  uint64_t bytes_of_profiles_ = 0;
};

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

}  // namespace tdpt::gltf
