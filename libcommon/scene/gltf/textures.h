// Textures of materials: which image, decoded once, and how it is reached. Internal to this room.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// A textureInfo that could be read.
struct Texture {
  TextureMap map;  ///< without its image, which keep() gives it
  size_t image = 0;
  bool uniform = false;              ///< all texels are the same
  std::array<float, 4> value{};      ///< the first texel, linear RGBA
  std::array<uint8_t, 4> encoded{};  ///< the same as it stands in the image
  float least_alpha = 1;             ///< of all texels
};

/// Extensions of a texture that name another image for it, the ones that are read first.
constexpr const char* kTextureFormats[] = {"EXT_texture_webp", "KHR_texture_basisu",
                                           "EXT_texture_avif", "MSFT_texture_dds"};

class TextureReader {
 public:
  TextureReader(const Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// Why there is no texture.
  struct Fault {
    bool far_uv_set = false;  ///< it asks for a third set of texture coordinates
    std::string image;        ///< what its image is: "KTX2, which is not read"; else empty
  };

  /// The texture that `info` names, the first of its images decoded that can be. Nothing where
  /// there is none, and `fault` says why. Throws InputError when an image lies outside the scene's
  /// folder or its buffer, or when all images together have too many texels.
  std::optional<Texture> read(const nlohmann::json& info, bool srgb, Fault& fault);

  /// The texture's map; its image is one of scene.images from now on.
  TextureMap keep(const Texture& texture);

  /// Content of external image files, for the scene's hash.
  const std::string& external_bytes() const { return external_bytes_; }

 private:
  struct Decoded {
    std::optional<Image> image;
    std::string fault;  ///< why there is none
    bool uniform = false;
    uint8_t least_alpha = 255;
    std::array<uint8_t, 4> first{};
    int32_t kept = -1;  ///< into scene.images
  };
  Decoded& decoded(size_t image);
  void decode(size_t image, Decoded& out);
  std::string_view bytes_of(size_t image, std::string& owned);

  const Document& document_;
  Scene& scene_;
  std::map<size_t, Decoded> known_;  // by image of the file
  std::string external_bytes_;
  int64_t texels_ = 0;  // of all images decoded so far
};

}  // namespace tdpt::gltf
