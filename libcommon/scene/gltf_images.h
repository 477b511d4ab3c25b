// Average colours of textures: what is left of them on a diffuse surface of one colour. Internal to
// this room; stb_image stays behind it.
#pragma once
#include <map>
#include <optional>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf_document.h"

namespace tdpt::gltf {

class TextureColours {
 public:
  explicit TextureColours(const Document& document) : document_(document) {}

  /// Mean of a texture's texels in linear Rec.709; nothing when there is no image that can be
  /// decoded. Throws InputError when its image lies outside the scene's folder or its buffer.
  std::optional<Vec3d> average(size_t texture);

  /// Content of external image files, for the scene's hash.
  const std::string& external_bytes() const { return external_bytes_; }

 private:
  std::optional<Vec3d> average_image(size_t image);

  const Document& document_;
  std::map<size_t, std::optional<Vec3d>> known_;  // by image
  std::string external_bytes_;
};

}  // namespace tdpt::gltf
