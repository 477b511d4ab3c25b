// The only caller of libwebp.
#include "libcommon/scene/gltf/images.h"

#include <webp/decode.h>
#include <algorithm>

namespace tdpt::gltf {
namespace {

// A uniform image needs no bits for its texels, so the size of a file does not bound its texels: up
// to 4096 x 4096 is always accepted, a larger image in proportion to its bytes.
constexpr int64_t kAlways = int64_t{1} << 24, kMostOfAByte = 4096;

const uint8_t* data_of(std::string_view bytes) {
  return reinterpret_cast<const uint8_t*>(bytes.data());
}

}  // namespace

bool is_webp(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

bool is_animated_webp(std::string_view bytes) {
  WebPBitstreamFeatures features;
  return is_webp(bytes) &&
         WebPGetFeatures(data_of(bytes), bytes.size(), &features) == VP8_STATUS_OK &&
         features.has_animation;
}

std::optional<int64_t> webp_texels_declared(std::string_view bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data_of(bytes), bytes.size(), &features) != VP8_STATUS_OK ||
      features.has_animation || features.width < 1 || features.height < 1)
    return {};
  const int64_t texels = int64_t{features.width} * features.height;
  if (texels > std::max(kAlways, kMostOfAByte * static_cast<int64_t>(bytes.size()))) return {};
  return texels;
}

std::optional<Image> decode_webp(std::string_view bytes) {
  Image out;
  if (!WebPGetInfo(data_of(bytes), bytes.size(), &out.width, &out.height)) return {};
  const size_t row = size_t{4} * static_cast<size_t>(out.width);
  out.texels.resize(row * static_cast<size_t>(out.height));
  if (!WebPDecodeRGBAInto(data_of(bytes), bytes.size(), out.texels.data(), out.texels.size(),
                          static_cast<int>(row)))
    return {};
  return out;
}

}  // namespace tdpt::gltf
