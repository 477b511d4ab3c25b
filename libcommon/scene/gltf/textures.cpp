#include "libcommon/scene/gltf/textures.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "libcommon/base/file.h"
#include "libcommon/scene/texture.h"

namespace tdpt::gltf {
namespace {

// A few bytes of a compressed image can decode to many texels, so these are limited.
constexpr int64_t kMostTexels = int64_t{1} << 26, kMostTexelsOfAll = int64_t{1} << 28;

// Extensions that name another image for a texture, in order of preference; unsupported formats
// come last.
constexpr const char* kFormats[] = {"EXT_texture_webp", "KHR_texture_basisu", "EXT_texture_avif",
                                    "MSFT_texture_dds"};

/// KHR_texture_transform: scale, then rotate, then translate. The rotation is counter-clockwise as
/// seen on the image, whose v runs downwards.
std::array<float, 6> read_transform(const Value& t) {
  std::vector<double> offset = t["offset"].numbers(2), scale = t["scale"].numbers(2);
  if (offset.empty()) offset = {0, 0};
  if (scale.empty()) scale = {1, 1};
  const double angle = t["rotation"].number(0), c = std::cos(angle), s = std::sin(angle);
  const std::array<double, 6> m{c * scale[0],  s * scale[1], offset[0],
                                -s * scale[0], c * scale[1], offset[1]};
  std::array<float, 6> out;
  for (size_t k = 0; k < 6; ++k) out[k] = static_cast<float>(std::clamp(m[k], -1e30, 1e30));
  return out;
}

TextureMap::Wrap read_wrap(const Value& v) {
  switch (v.integer(10497)) {
    case 10497:
      return TextureMap::Wrap::repeat;
    case 33648:
      return TextureMap::Wrap::mirror;
    case 33071:
      return TextureMap::Wrap::clamp;
    default:
      v.fail("10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge)");
  }
}

bool read_nearest(const Value& v) {
  constexpr size_t kNearest = 9728, kLinear = 9729;
  const size_t filter = v.integer(kLinear);
  if (filter != kNearest && filter != kLinear) v.fail("9728 (nearest) or 9729 (linear)");
  return filter == kNearest;
}

}  // namespace

TextureInfo read_texture_info(const Value& v) {
  TextureInfo out;
  if (!v) return out;
  out.texture = v["index"].needed().index("textures");
  out.uv_set = v["texCoord"].integer(0);
  out.scale = v["scale"].number(1);
  if (const Value transform = v.extension("KHR_texture_transform")) {
    out.uv_set = transform["texCoord"].integer(out.uv_set);
    out.transform = read_transform(transform);
  }
  return out;
}

TextureReader::TextureReader(const Document& d, Scene& scene) : document_(d), scene_(scene) {
  std::vector<TextureMap> samplers;
  for (const Value& v : d.root()["samplers"].items()) {
    TextureMap& map = samplers.emplace_back();
    map.nearest = read_nearest(v["magFilter"]);
    map.wrap_u = read_wrap(v["wrapS"]);
    map.wrap_v = read_wrap(v["wrapT"]);
  }
  for (const Value& v : d.root()["textures"].items()) {
    Source& source = sources_.emplace_back();
    const auto add = [&](const Value& owner) {
      if (const size_t image = owner["source"].index("images"); image != kNone)
        source.images.push_back(image);
    };
    for (const char* format : kFormats) {
      add(v.extension(format));
      if (format == kFormats[0]) add(v);
    }
    if (const size_t sampler = v["sampler"].index("samplers"); sampler != kNone)
      source.map = samplers[sampler];
  }
  for (const Value& v : d.root()["images"].items()) {
    files_.push_back({v["uri"], v["bufferView"].index("bufferViews")});
    if (const Value uri = v["uri"]; uri && !uri.json().is_string()) uri.fail("a string");
  }
}

std::string_view TextureReader::bytes_of(size_t index, std::string& owned) {
  const File& f = files_[index];
  if (f.view != kNone) return view_bytes(document_, f.view);
  if (!f.uri) return {};
  const std::string where = place("images", index);
  std::string file;
  owned = read_uri(document_, f.uri.text(), where + ".uri", file);
  if (!file.empty()) {
    external_bytes_ += owned;
    expect_memory(document_.file, where,
                  fmt::format("{} bytes of image files", external_bytes_.size()),
                  2 * external_bytes_.size());
    scene_.files.push_back(file);
  }
  return owned;
}

void TextureReader::decode(size_t index, DecodedImage& out) {
  const std::string where = place("images", index);
  std::string owned;
  std::string_view bytes;
  try {
    bytes = bytes_of(index, owned);
  } catch (const NothingThere& nothing) {
    out.fault = nothing.what_is;
    return;
  }
  const std::optional<int64_t> texels = texels_declared(bytes);
  if (texels && *texels > kMostTexels) {
    out.fault = fmt::format("an image of {} texels, at most {} are read", *texels, kMostTexels);
    return;
  }
  texels_ += texels.value_or(0);
  if (texels_ > kMostTexelsOfAll)
    document_.fail(where, fmt::format("brings the scene to {} texels, expected at most {}", texels_,
                                      kMostTexelsOfAll));
  expect_memory(document_.file, where, fmt::format("{} texels, with those before,", texels_),
                4 * static_cast<uint64_t>(texels_));
  if (texels) out.image = decode_image(bytes);
  if (!out.image) out.fault = fault_of_image(bytes);
}

DecodedImage& TextureReader::decoded(size_t index) {
  const auto [it, is_new] = known_.try_emplace(index);
  DecodedImage& d = it->second;
  if (!is_new) return d;
  decode(index, d);
  if (!d.image) return d;
  const std::vector<uint8_t>& t = d.image->texels;
  std::copy_n(t.begin(), 4, d.first.begin());
  d.uniform = std::memcmp(t.data(), t.data() + 4, t.size() - 4) == 0;
  for (size_t k = 3; k < t.size(); k += 4) d.least_alpha = std::min(d.least_alpha, t[k]);
  return d;
}

std::optional<Texture> TextureReader::read(const TextureInfo& info, bool srgb, std::string& fault) {
  if (info.uv_set > 1) {
    fault = fmt::format("on TEXCOORD_{}", info.uv_set);
    return {};
  }
  const Source& texture = sources_[info.texture];
  std::string first_fault = "without an image";
  for (const size_t source : texture.images) {
    DecodedImage& image = decoded(source);
    if (!image.fault.empty()) {
      if (source == texture.images.front()) first_fault = image.fault;
      continue;
    }
    Texture out;
    out.image = &image;
    out.map = texture.map;
    out.map.transform = info.transform;
    out.map.srgb = srgb;
    out.map.uv_set = static_cast<uint8_t>(info.uv_set);
    for (size_t c = 0; c < 4; ++c)
      out.value[c] = (srgb && c < 3 ? linear_of_srgb() : linear_of_byte())[image.first[c]];
    return out;
  }
  fault = first_fault;
  return {};
}

TextureMap TextureReader::keep(const Texture& texture) {
  DecodedImage& d = *texture.image;
  if (d.kept < 0) {
    d.kept = static_cast<int32_t>(scene_.images.size());
    scene_.images.push_back(std::move(*d.image));
    d.image.reset();
  }
  TextureMap map = texture.map;
  map.image = d.kept;
  return map;
}

}  // namespace tdpt::gltf
