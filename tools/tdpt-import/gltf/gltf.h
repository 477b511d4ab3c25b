// What the chapters of the writer share: the file as JSON and bytes, its materials, its sky.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/gltf/writer.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign {

using GltfJson = nlohmann::ordered_json;

/// A .glb that is being written: its JSON, and the binary part that the JSON describes.
class Glb {
 public:
  GltfJson root{};

  // Each returns the index of its accessor.
  size_t positions(const std::vector<Vec3f>& values);
  size_t normals(const std::vector<Vec3f>& values);
  size_t uv(const std::vector<std::array<float, 2>>& values);
  size_t indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices);
  /// The index of its bufferView.
  size_t bytes(std::string_view bytes, int target = 0);

  /// The whole file.
  std::string file();

 private:
  size_t accessor(std::string_view bytes, int target, int type, size_t count, const char* shape);

  std::string bin_;
};

/// The scene's materials and their textures as glTF has them: 8 bits, PNG or JPEG. Files pass
/// through unchanged where that is right. An image that cannot be decoded is named as lost and left
/// out.
class Surfaces {
 public:
  /// `longest`: longer sides of textures are scaled down to it; 0: none are.
  Surfaces(const Described& scene, Glb& glb, Source& source, int longest)
      : scene_(scene), glb_(glb), source_(source), longest_(longest) {}

  struct Written {
    size_t index = 0;
    bool textured = false;  ///< its meshes need texture coordinates
  };
  /// glTF's material for a surface that may emit.
  Written written(size_t material, const std::optional<Emission>& emission);
  /// Of all materials so far.
  const std::set<std::string>& extensions() const { return extensions_; }

 private:
  // Textures: each returns a textureInfo of glTF, null without a texture. Base colour or emission
  // has the opacity in alpha if its texture is given; texels are divided by `scale`.
  GltfJson colour(const Colour& colour, const Number* opacity = nullptr, float scale = 1);
  GltfJson roughness(const Number& roughness);  // in green
  GltfJson normal_map(const Texture& texture);
  float largest(const Colour& colour);
  const Texels* texels(const Texture& texture);
  bool passes(const Texture& texture);
  GltfJson info(const Texture& texture, const std::string& bytes);
  void add_map(const Texture& texture, GltfJson& info);

  GltfJson surface(const Material& m);
  void add_layers(const Material& m, GltfJson& out);
  void add_emission(const Emission& e, GltfJson& out);
  GltfJson& extension(GltfJson& out, const char* name);
  void lose(const std::string& sentence) { source_.lose({source_.path(), ""}, sentence); }

  const Described& scene_;
  Glb& glb_;
  Source& source_;
  int longest_;
  std::map<size_t, Texels> decoded_;  ///< by image; empty: cannot be decoded
  std::map<std::string, size_t> images_, samplers_, textures_;
  std::map<std::string, size_t> written_;  ///< by its JSON
  std::map<size_t, Written> dark_;         ///< by material, those that emit nothing
  std::set<std::string> extensions_;
};

struct WrittenSky {
  std::string suffix,
      bytes;  ///< of the file beside the scene, ".exr" or ".hdr"; empty: there is none
  GltfJson extras = GltfJson::object();  ///< keys of the scene's extras but the name of the file
};
/// A map that only has to be turned about +y is copied; any other is resampled in the scene's
/// frame. Empty extras: there is no light.
WrittenSky written_sky(const Described& scene, const Frame& frame, Source& source);

}  // namespace tdpt::foreign
