// A described scene as a .glb, its environment and its portals beside it; and what the chapters of
// the writer share.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "libcommon/base/provenance.h"
#include "libcommon/formats/glb.h"
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

struct GltfOptions {
  std::string up = "auto";    ///< the axis x, y or z; auto: by the camera
  int longest_texture = 0;    ///< longer sides of textures are scaled down to it; 0: none are
  std::string environment{};  ///< name of the file beside the scene, without suffix
  std::string format{};       ///< of the source, such as "Tungsten"
  Provenance provenance{};
};

struct GltfOutput {
  std::string glb;
  std::string environment, environment_suffix;  ///< its bytes; empty: there is no such file
  std::string portals;                          ///< a file of portals; empty: there are none
  Frame frame;
  size_t triangles = 0, shapes = 0, materials = 0, textures = 0, emitters = 0;
};

/// Names what glTF cannot hold as lost.
GltfOutput write_gltf(const Described& scene, const GltfOptions& writing, Source& source);

using GltfJson = nlohmann::ordered_json;

/// The .glb that is being written, and what was written of the scene so far.
struct GltfFile {
  const Described& scene;
  const GltfOptions& how;
  Source& source;
  GltfOutput out{};
  Glb<GltfJson> glb{};
  std::set<std::string> extensions{};
  std::map<std::string, std::map<std::string, size_t>> known{};  ///< by section and JSON
  std::map<std::string, size_t> images{};                        ///< by the hash of their bytes
  std::map<size_t, Texels> decoded{};                   ///< by image; empty: cannot be decoded
  std::map<std::array<size_t, 3>, size_t> meshes{};     ///< by number, material, turned
  std::map<std::array<size_t, 3>, size_t> accessors{};  ///< by attribute, number, turned
  std::map<size_t, std::pair<size_t, bool>> dark_surfaces{};  ///< by material: material_index()
  bool is_textured = false;  ///< the material that is being written

  /// Adds an element to a list of the root, unless there is an equal one; its index.
  size_t index_of(const char* section, const GltfJson& value);
  /// An extension of an object.
  GltfJson& extension(GltfJson& object, const char* name);
  void lose(const std::string& sentence) { source.lose({source.path(), ""}, sentence); }
};

/// glTF's material for a surface that may emit: its index, and whether its meshes need texture
/// coordinates. Textures have 8 bits, PNG or JPEG; files pass through unchanged where that is
/// right. An image that cannot be decoded is named as lost and left out.
std::pair<size_t, bool> material_index(GltfFile& f, size_t material,
                                       const std::optional<Emission>& emission);

/// Adds the keys of the sky to the scene's extras, and its file. A map that only has to be turned
/// about +y is copied; any other is resampled in the scene's frame.
void add_sky(GltfFile& f, GltfJson& extras);

}  // namespace tdpt::foreign
