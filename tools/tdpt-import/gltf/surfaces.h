// Materials of a .glb and their textures as glTF has them: 8 bits, PNG or JPEG. Files pass through
// unchanged where that is right.
#pragma once
#include <map>
#include <set>
#include <string>

#include "tools/tdpt-import/gltf/buffer.h"
#include "tools/tdpt-import/images.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

class Textures {
 public:
  /// `longest`: longer sides are scaled down to it; 0: none are.
  Textures(const Described& scene, GltfJson& root, Buffer& buffer, Source& source, int longest)
      : scene_(scene), root_(root), buffer_(buffer), source_(source), longest_(longest) {}

  // Each returns a textureInfo of glTF, null without a texture. An image that cannot be decoded is
  // named as lost and left out.

  /// Base colour or emission, with the opacity in alpha if its texture is given. Texels are divided
  /// by `scale`.
  GltfJson colour(const Colour& colour, const Number* opacity = nullptr, float scale = 1);
  /// Roughness in green.
  GltfJson roughness(const Number& roughness);
  GltfJson normal_map(const Texture& texture);

  /// Largest component of a colour's texels after its curve; 1 without a texture.
  float largest(const Colour& colour);

 private:
  const Texels* texels(const Texture& texture);
  bool passes(const Texture& texture);
  GltfJson info(const Texture& texture, const std::string& bytes, const std::string& name);
  GltfJson sampler(const Texture& texture) const;
  void add_map(const Texture& texture, GltfJson& info);

  const Described& scene_;
  GltfJson& root_;
  Buffer& buffer_;
  Source& source_;
  int longest_;
  std::map<size_t, Texels> decoded_;  ///< by image; empty: cannot be decoded
  std::map<std::string, size_t> images_, samplers_, textures_;
};

class Surfaces {
 public:
  Surfaces(const Described& scene, GltfJson& root, Textures& textures, Source& source)
      : scene_(scene), root_(root), textures_(textures), source_(source) {}

  struct Written {
    size_t index = 0;
    bool textured = false;  ///< its meshes need texture coordinates
  };
  /// glTF's material for a surface that may emit.
  Written of(size_t material, const std::optional<Emission>& emission);
  /// Of all materials so far.
  const std::set<std::string>& extensions() const { return extensions_; }

 private:
  GltfJson surface(const Material& m);
  void add_layers(const Material& m, GltfJson& out);
  void add_emission(const Emission& e, GltfJson& out);
  GltfJson& extension(GltfJson& out, const char* name);

  const Described& scene_;
  GltfJson& root_;
  Textures& textures_;
  Source& source_;
  std::map<std::string, size_t> written_;  ///< by its JSON
  std::map<size_t, Written> dark_;         ///< by material, those that emit nothing
  std::set<std::string> extensions_;
};

}  // namespace tdpt::foreign
