// Textures of materials: decodes each image once and finds the map to it. Internal to this room.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// A textureInfo, what a material says of a texture.
struct TextureInfo {
  size_t texture = kNone;
  size_t uv_set = 0;
  std::array<float, 6> transform = TextureMap().transform;
  double scale = 1;  ///< of a normal map
  explicit operator bool() const { return texture != kNone; }
};

/// Throws InputError.
TextureInfo read_texture_info(const Value& info);

// Images in memory, from untrusted sources: PNG, JPEG and WebP.

/// Texels that an image declares in its header; empty if it is of another format, or if so few
/// bytes cannot hold so many.
std::optional<int64_t> texels_declared(std::string_view bytes);

/// The image; empty if it cannot be decoded. Equal bytes give equal texels, even if damaged.
std::optional<Image> decode_image(std::string_view bytes);

/// Describes an image that cannot be decoded: "KTX2, which is not read", "a PNG that cannot be
/// decoded".
std::string fault_of_image(std::string_view bytes);

/// An image of the file that was to be decoded.
struct DecodedImage {
  std::optional<Image> image;
  std::string fault;     ///< why it could not be decoded
  bool uniform = false;  ///< all texels are equal
  uint8_t least_alpha = 255;
  std::array<uint8_t, 4> first{};  ///< the first texel
  int32_t kept = -1;               ///< index into scene.images
};

struct Texture {
  TextureMap map;  ///< without its image, which keep() gives it
  DecodedImage* image = nullptr;
  std::array<float, 4> value{};  ///< the first texel, linear RGBA
};

class TextureReader {
 public:
  /// Reads textures, samplers and images of the file, without decoding any. Throws InputError.
  TextureReader(const Document& document, Scene& scene);

  /// The texture that `info` names, from the first of its images that can be decoded. Empty if
  /// there is none; then `fault` says why: "KTX2, which is not read". Throws InputError if an image
  /// lies outside the scene's folder or its buffer, or if all images together have too many texels.
  std::optional<Texture> read(const TextureInfo& info, bool srgb, std::string& fault);

  /// The texture's map, after adding its image to scene.images.
  TextureMap keep(const Texture& texture);

  /// Content of external image files, for the scene's hash.
  const std::string& external_bytes() const { return external_bytes_; }

 private:
  DecodedImage& decoded(size_t image);
  void decode(size_t image, DecodedImage& out);
  std::string_view bytes_of(size_t image, std::string& owned);

  struct Source {
    std::vector<size_t> images;  ///< in order of preference
    TextureMap map;              ///< as its sampler says
  };
  struct File {
    Value uri;
    size_t view = kNone;
  };

  const Document& document_;
  Scene& scene_;
  std::vector<Source> sources_;
  std::vector<File> files_;
  std::map<size_t, DecodedImage> known_;  // by index of the image in the file
  std::string external_bytes_;
  int64_t texels_ = 0;  // sum over all images decoded so far
};

}  // namespace tdpt::gltf
