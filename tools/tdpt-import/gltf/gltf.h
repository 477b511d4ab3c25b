// A described scene as a .glb, its environment and its portals beside it; and what the chapters of
// the writer share.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/base/provenance.h"
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign {

/// The frame in which a scene is written: right-handed, +y up, as glTF wants it.
struct Frame {
  Affine to_gltf{};       ///< orthogonal; of the source's coordinates
  bool mirrored = false;  ///< the source's frame is left-handed
  std::string up = "y";   ///< the axis that is up in the source, or down if `downwards`
  bool downwards = false;
};

struct Writing {
  std::string up = "auto";    ///< the axis x, y or z; auto: by the camera
  int longest_texture = 0;    ///< longer sides of textures are scaled down to it; 0: none are
  std::string environment{};  ///< name of the file beside the scene, without suffix
  std::string format{};       ///< of the source, such as "Tungsten"
  Provenance provenance{};
};

struct Written {
  std::string glb;
  std::string environment, environment_suffix;  ///< its bytes; empty: there is no such file
  std::string portals;                          ///< a file of portals; empty: there are none
  Frame frame;
  size_t triangles = 0, shapes = 0, materials = 0, textures = 0, emitters = 0;
};

/// Names what glTF cannot hold as lost.
Written written(const Described& scene, const Writing& writing, Source& source);

using GltfJson = nlohmann::ordered_json;

/// A .glb that is being written: its JSON, and the binary part that the JSON describes.
struct Glb {
  GltfJson root{};
  std::string bin{};

  /// Adds an element to a list of the root; its index.
  size_t add(const char* section, GltfJson value);
  /// Adds bytes to the binary part; the index of their bufferView.
  size_t add(std::string_view bytes, int target = 0);
  /// The whole file.
  std::string file();
};

/// The scene's materials and their textures as glTF has them: 8 bits, PNG or JPEG. Files pass
/// through unchanged where that is right. An image that cannot be decoded is named as lost and left
/// out.
class Surfaces {
 public:
  Surfaces(const Described& scene, Glb& glb, Source& source, int longest_texture)
      : scene_(scene), glb_(glb), source_(source), longest_(longest_texture) {}

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
  GltfJson transform(const Texture& texture);
  size_t index_of(const char* section, const GltfJson& value);

  GltfJson surface(const Material& m);
  void add_layers(const Material& m, GltfJson& out);
  void add_emission(const Emission& e, GltfJson& out);
  GltfJson& extension(GltfJson& out, const char* name);
  void lose(const std::string& sentence) { source_.lose({source_.path(), ""}, sentence); }

  const Described& scene_;
  Glb& glb_;
  Source& source_;
  int longest_;
  std::map<size_t, Texels> decoded_;      ///< by image; empty: cannot be decoded
  std::map<std::string, size_t> images_;  ///< by the hash of their bytes
  std::map<std::string, std::map<std::string, size_t>> known_{};  ///< by section and JSON
  std::map<size_t, Written> dark_;  ///< by material, those that emit nothing
  std::set<std::string> extensions_;
  bool textured_ = false;  ///< the material that is being written
};

/// Adds the keys of the sky to the scene's extras, and its file to `out`. A map that only has to be
/// turned about +y is copied; any other is resampled in the scene's frame. `name`: of the file,
/// without suffix.
void add_sky(const Described& scene, Source& source, const std::string& name, GltfJson& extras,
             Written& out);

}  // namespace tdpt::foreign
