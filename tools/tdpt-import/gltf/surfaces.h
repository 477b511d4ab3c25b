// Materials of a .glb.
#pragma once
#include <map>
#include <set>
#include <string>

#include "tools/tdpt-import/gltf/textures.h"

namespace tdpt::foreign {

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
