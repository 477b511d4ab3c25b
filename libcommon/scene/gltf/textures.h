// Loads textures of materials: decodes each image once and finds the map to it. Internal to this
// room.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// A textureInfo that was read.
struct Texture {
  TextureMap map;  ///< without its image, which keep() gives it
  size_t image = 0;
  bool uniform = false;              ///< all texels are equal
  std::array<float, 4> value{};      ///< the first texel, linear RGBA
  std::array<uint8_t, 4> encoded{};  ///< the same, as stored in the image
  float least_alpha = 1;             ///< minimum over all texels
};

/// Extensions that name another image for a texture, in order of preference.
constexpr const char* kTextureFormats[] = {"EXT_texture_webp", "KHR_texture_basisu",
                                           "EXT_texture_avif", "MSFT_texture_dds"};

class TextureReader {
 public:
  TextureReader(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// Why there is no texture.
  struct Fault {
    bool far_uv_set = false;  ///< it asks for a third set of texture coordinates
    std::string image;        ///< describes its image: "KTX2, which is not read"; else empty
  };

  /// The texture that `info` names, from the first of its images that can be decoded. Empty if
  /// there is none; then `fault` says why. Throws InputError if an image lies outside the scene's
  /// folder or its buffer, or if all images together have too many texels.
  std::optional<Texture> read(const nlohmann::json& info, bool srgb, Fault& fault);

  /// The texture's map, after adding its image to scene.images.
  TextureMap keep(const Texture& texture);

  /// Content of external image files, for the scene's hash.
  const std::string& external_bytes() const { return external_bytes_; }

 private:
  struct Decoded {
    std::optional<Image> image;
    std::string fault;  ///< why it could not be decoded
    bool uniform = false;
    uint8_t least_alpha = 255;
    std::array<uint8_t, 4> first{};
    int32_t kept = -1;  ///< index into scene.images
  };
  Decoded& decoded(size_t image);
  void decode(size_t image, Decoded& out);
  std::string_view bytes_of(size_t image, std::string& owned);

  const Document& document_;
  Scene& scene_;
  std::map<size_t, Decoded> known_;  // by index of the image in the file
  std::string external_bytes_;
  int64_t texels_ = 0;  // sum over all images decoded so far
};

}  // namespace tdpt::gltf
