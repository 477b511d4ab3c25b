#include "libcommon/scene/gltf/textures.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/images.h"
#include "libcommon/scene/texture.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

// A few bytes of a compressed image can decode to many texels, so these are limited.
constexpr int64_t kMostTexels = int64_t{1} << 26, kMostTexelsOfAll = int64_t{1} << 28;

constexpr int kRepeat = 10497, kMirror = 33648, kNearest = 9728;

/// KHR_texture_transform: scale, then rotate, then translate. The rotation is counter-clockwise as
/// seen on the image, whose v runs downwards.
void set_transform(const Json& t, TextureMap& map) {
  const auto pair = [&](const char* name, double otherwise) {
    return t.contains(name) ? Vec3d(t[name][0].get<double>(), t[name][1].get<double>(), 0)
                            : Vec3d(otherwise);
  };
  const Vec3d offset = pair("offset", 0), scale = pair("scale", 1);
  const double angle = t.value("rotation", 0.0), c = std::cos(angle), s = std::sin(angle);
  const std::array<double, 6> m{c * scale.x,  s * scale.y, offset.x,
                                -s * scale.x, c * scale.y, offset.y};
  for (size_t k = 0; k < 6; ++k)
    map.transform[k] = static_cast<float>(std::clamp(m[k], -1e30, 1e30));
}

TextureMap::Wrap wrap_of(const Json& sampler, const char* name) {
  const int wrap = sampler.value(name, kRepeat);
  return wrap == kRepeat   ? TextureMap::Wrap::repeat
         : wrap == kMirror ? TextureMap::Wrap::mirror
                           : TextureMap::Wrap::clamp;
}

/// Images of a texture in order of preference; unsupported formats come last.
std::vector<size_t> sources_of(const Json& texture) {
  std::vector<size_t> out;
  const auto add = [&](const Json& owner) {
    if (owner.contains("source")) out.push_back(owner["source"].get<size_t>());
  };
  const Json extensions = texture.value("extensions", Json::object());
  for (const char* format : kTextureFormats) {
    if (extensions.contains(format)) add(extensions[format]);
    if (format == kTextureFormats[0]) add(texture);
  }
  return out;
}

}  // namespace

std::string_view TextureReader::bytes_of(size_t index, std::string& owned) {
  const Json& i = document_.json["images"][index];
  if (i.contains("bufferView")) return view_bytes(document_, i["bufferView"].get<size_t>());
  if (!i.contains("uri")) return {};
  const std::string where = place("images", index);
  std::string file;
  owned = read_uri(document_, i["uri"].get<std::string>(), where + ".uri", file);
  if (!file.empty()) {
    external_bytes_ += owned;
    expect_memory(document_.file, where,
                  fmt::format("{} bytes of image files", external_bytes_.size()),
                  2 * external_bytes_.size());
    scene_.files.push_back(file);
  }
  return owned;
}

void TextureReader::decode(size_t index, Decoded& out) {
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

TextureReader::Decoded& TextureReader::decoded(size_t index) {
  const auto [it, is_new] = known_.try_emplace(index);
  Decoded& d = it->second;
  if (!is_new) return d;
  decode(index, d);
  if (!d.image) return d;
  const std::vector<uint8_t>& t = d.image->texels;
  std::copy_n(t.begin(), 4, d.first.begin());
  d.uniform = std::memcmp(t.data(), t.data() + 4, t.size() - 4) == 0;
  for (size_t k = 3; k < t.size(); k += 4) d.least_alpha = std::min(d.least_alpha, t[k]);
  return d;
}

std::optional<Texture> TextureReader::read(const Json& info, bool srgb, Fault& fault) {
  static const Json kNothing = Json::object();
  Texture out;
  size_t uv_set = info.value("texCoord", size_t{0});
  if (info.contains("extensions") && info["extensions"].contains("KHR_texture_transform")) {
    const Json& t = info["extensions"]["KHR_texture_transform"];
    uv_set = t.value("texCoord", uv_set);
    set_transform(t, out.map);
  }
  const Json& texture = document_.json["textures"][info["index"].get<size_t>()];
  fault = {uv_set > 1, ""};
  if (fault.far_uv_set) return {};
  const Decoded* found = nullptr;
  for (const size_t source : sources_of(texture)) {
    const Decoded& tried = decoded(source);
    if (fault.image.empty()) fault.image = tried.fault;
    if (!tried.fault.empty()) continue;
    found = &tried;
    out.image = source;
    break;
  }
  if (!found && fault.image.empty()) fault.image = "without an image";
  if (!found) return {};
  fault.image.clear();
  const Decoded& image = *found;

  const Json& sampler = texture.contains("sampler")
                            ? document_.json["samplers"][texture["sampler"].get<size_t>()]
                            : kNothing;
  out.map.srgb = srgb;
  out.map.uv_set = static_cast<uint8_t>(uv_set);
  out.map.nearest = sampler.value("magFilter", 0) == kNearest;
  out.map.wrap_u = wrap_of(sampler, "wrapS");
  out.map.wrap_v = wrap_of(sampler, "wrapT");
  out.uniform = image.uniform;
  out.encoded = image.first;
  for (size_t c = 0; c < 4; ++c)
    out.value[c] = (srgb && c < 3 ? linear_of_srgb() : linear_of_byte())[image.first[c]];
  out.least_alpha = linear_of_byte()[image.least_alpha];
  return out;
}

TextureMap TextureReader::keep(const Texture& texture) {
  Decoded& d = known_.at(texture.image);
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
