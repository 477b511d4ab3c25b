#include "libcommon/scene/gltf_images.h"

#include <stb/stb_image.h>
#include <array>
#include <cmath>
#include <memory>

namespace tdpt::gltf {
namespace {

constexpr int64_t kMostTexels = int64_t{1} << 26;

std::array<double, 256> linear_of_srgb() {
  std::array<double, 256> table{};
  for (size_t i = 0; i < 256; ++i) {
    const double c = static_cast<double>(i) / 255;
    table[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return table;
}

std::optional<Vec3d> decode_average(std::string_view bytes) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  if (bytes.size() > (size_t{1} << 30)) return {};
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data, size, &width, &height, &channels)) return {};
  if (int64_t{width} * height > kMostTexels) return {};
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(data, size, &width, &height, &channels, 3), stbi_image_free);
  if (!texels || width <= 0 || height <= 0) return {};
  std::array<std::array<uint64_t, 256>, 3> histogram{};  // exact whatever the order
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  for (size_t i = 0; i < 3 * n; ++i) ++histogram[i % 3][texels.get()[i]];
  static const std::array<double, 256> linear = linear_of_srgb();
  Vec3d sum;
  for (int c = 0; c < 3; ++c)
    for (size_t v = 0; v < 256; ++v)
      sum[c] += linear[v] * static_cast<double>(histogram[static_cast<size_t>(c)][v]);
  return sum / static_cast<double>(n);
}

}  // namespace

std::optional<Vec3d> TextureColours::average(size_t texture) {
  const nlohmann::json& t = document_.json["textures"][texture];
  if (!t.contains("source")) return {};
  const auto image = t["source"].get<size_t>();
  const auto [it, is_new] = known_.try_emplace(image);
  if (is_new) it->second = average_image(image);
  return it->second;
}

std::optional<Vec3d> TextureColours::average_image(size_t image) {
  const nlohmann::json& i = document_.json["images"][image];
  if (i.contains("bufferView"))
    return decode_average(view_bytes(document_, i["bufferView"].get<size_t>()));
  if (!i.contains("uri")) return {};
  bool external = false;
  const std::string bytes =
      read_uri(document_, i["uri"].get<std::string>(), place("images", image) + ".uri", external);
  if (external) external_bytes_ += bytes;
  return decode_average(bytes);
}

}  // namespace tdpt::gltf
