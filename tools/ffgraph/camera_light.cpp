#include "tools/ffgraph/camera_light.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
namespace {

// Jacobi iterations: light is followed over so many surfaces, unless it changes less before.
constexpr int kMostBounces = 64, kFewestBounces = 12;
constexpr double kSettled = 2e-3;     // relative change of the picture's light
constexpr double kMostAlbedo = 0.95;  // closed rooms of white walls keep light for ever
constexpr size_t kTexels = 4096;      // of a texture, for its mean

double unit_of_srgb(uint8_t byte) {
  const double c = byte / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

Rgb mean_of(const Image& image, bool srgb) {
  const size_t texels = image.texels.size() / 4;
  if (texels == 0) return Rgb(1.0f);
  const size_t step = std::max<size_t>(1, texels / kTexels);
  Vec3d sum{};
  double n = 0;
  for (size_t t = 0; t < texels; t += step, ++n)
    for (int c = 0; c < 3; ++c) {
      const uint8_t byte = image.texels[4 * t + static_cast<size_t>(c)];
      sum[c] += srgb ? unit_of_srgb(byte) : byte / 255.0;
    }
  return Rgb(sum / n);
}

// Irradiance and importance of a patch.
struct State {
  double e = 0, m = 0;
};

}  // namespace

std::vector<double> albedos_of(const Scene& scene) {
  std::vector<double> albedo;
  for (const Material& m : scene.materials) {
    Rgb colour = m.base_color;
    if (const TextureMap& map = m.maps[MAP_BASE])
      colour = colour * mean_of(scene.images[static_cast<size_t>(map.image)], map.srgb);
    const double all = luminance(colour) * (1 - m.transmission * (1 - m.metallic));
    albedo.push_back(std::clamp(all, 0.0, kMostAlbedo));
  }
  return albedo;
}

std::vector<PatchLight> camera_light(const PatchMap& patches, const Etendue& etendue,
                                     const std::vector<PatchTerms>& terms) {
  const size_t n = terms.size();
  // What leaves each patch and is handed on: albedo per sample.
  std::vector<double> handed(n, 0);
  for (uint32_t i = 0; i < n; ++i)
    if (!patches.is_sky(i) && etendue.samples[i] > 0)
      handed[i] = terms[i].albedo / etendue.samples[i];
  // State times samples: power received.
  std::vector<State> received(n), next(n);
  for (size_t i = 0; i < n; ++i) received[i] = {terms[i].direct, terms[i].seen};
  double picture = 0;
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    for (size_t i = 0; i < n; ++i) next[i] = {terms[i].direct, terms[i].seen};
    for (const Etendue::Pair& p : etendue.pairs) {
      const double to_j = 0.5 * p.count * handed[p.i], to_i = 0.5 * p.count * handed[p.j];
      next[p.j].e += to_j * received[p.i].e, next[p.j].m += to_j * received[p.i].m;
      next[p.i].e += to_i * received[p.j].e, next[p.i].m += to_i * received[p.j].m;
    }
    received.swap(next);
    const double before = picture;
    picture = 0;
    for (size_t i = 0; i < n; ++i) picture += terms[i].seen * handed[i] * received[i].e;
    if (bounce >= kFewestBounces && std::abs(picture - before) <= kSettled * picture) break;
  }
  if (!(picture > 0)) return {};
  std::vector<double> exchanged(n, 0);  // of bins of the sky, n_i = sum of n_ij / 2
  for (const Etendue::Pair& p : etendue.pairs)
    for (const uint32_t end : {p.i, p.j}) exchanged[end] += 0.5 * p.count;
  std::vector<PatchLight> light(n);
  for (uint32_t i = 0; i < n; ++i) {
    const double samples = patches.is_sky(i) ? exchanged[i] : etendue.samples[i];
    if (!(samples > 0)) continue;
    light[i].brightness = (terms[i].emitted / samples + handed[i] * received[i].e) / picture;
    light[i].importance = handed[i] * received[i].m;
  }
  return light;
}

}  // namespace tdpt
