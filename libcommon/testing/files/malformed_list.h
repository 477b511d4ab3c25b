// Collects malformed scenes: a valid scene, and ways to corrupt it. Internal to malformed*.cpp.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/malformed.h"

namespace tdpt::testing {

using Json = nlohmann::ordered_json;

/// A valid scene: one square, one material, one camera. accessors[0] positions, accessors[1]
/// indices; nodes[0] the square, nodes[1] the camera.
inline GlbBuilder square() {
  GlbBuilder b;
  const int position = b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  const int index = b.indices_u16({0, 1, 2, 0, 2, 3});
  b.material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  const int mesh =
      b.mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}, {"material", 0}});
  b.node({{"mesh", mesh}});
  b.camera("camera", {0.5, 0.5, 2}, {0.5, 0.5, 0}, 1, 1);
  return b;
}

class MalformedList {
 public:
  std::vector<MalformedScene> scenes;

  /// Arbitrary bytes.
  void raw(const std::string& name, std::string bytes, const std::string& expected) {
    const bool glb = bytes.starts_with("glTF");
    scenes.push_back({name + (glb ? ".glb" : ".gltf"), std::move(bytes), expected});
  }
  /// The valid scene as .glb with corrupted bytes.
  void spoil_bytes(const std::string& name, const std::function<void(std::string&)>& spoil,
                   const std::string& expected) {
    std::string bytes = square().glb();
    spoil(bytes);
    scenes.push_back({name + ".glb", bytes, expected});
  }
  /// The valid scene with corrupted parts.
  void spoil(const std::string& name, const std::function<void(GlbBuilder&)>& spoil,
             const std::string& expected) {
    GlbBuilder b = square();
    spoil(b);
    scenes.push_back({name + ".glb", b.glb(), expected});
  }
  /// The valid scene with one value of its JSON replaced; `at` is a JSON pointer.
  void replace(const std::string& name, const std::string& at, const Json& value,
               const std::string& expected) {
    spoil(
        name, [&](GlbBuilder& b) { b.json[Json::json_pointer(at)] = value; }, expected);
  }
  /// The valid scene with its buffer at another URI.
  void uri(const std::string& name, const std::string& uri, const std::string& expected) {
    Json j = Json::parse(square().gltf());
    j["buffers"][0]["uri"] = uri;
    scenes.push_back({name + ".gltf", j.dump(1), expected});
  }
};

/// Invalid vertex attributes, materials, textures and lights.
void add_malformed_surfaces(MalformedList& list);

/// Invalid Draco meshes and meshoptimizer bufferViews.
void add_malformed_compressed(MalformedList& list);

/// Invalid instances, skins, morph targets and animations.
void add_malformed_motion(MalformedList& list);

}  // namespace tdpt::testing
