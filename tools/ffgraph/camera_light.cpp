#include "tools/ffgraph/camera_light.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
namespace {

// Jacobi iterations: light is followed over so many surfaces, unless it changes less before.
constexpr int kMostBounces = 64, kFewestBounces = 12;
constexpr double kSettled = 2e-3;     // relative change of the picture's light
constexpr double kMostAlbedo = 0.95;  // closed rooms of white walls keep light for ever
constexpr double kDarkest = 1e-3;     // of the mean pixel: darker ones count as if they had it
constexpr double kSpread = 0.1;       // share of the sky's light
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

// Solves x_i = begin_i + sum_j n_ij/2 handed_j x_j, x in power, until sum_i measure_i x_i settles.
std::vector<double> transported(const Etendue& etendue, const std::vector<double>& handed,
                                const std::vector<double>& begin,
                                const std::vector<double>& measure) {
  std::vector<double> x = begin, next;
  double sum = 0;
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    next = begin;
    for (const Etendue::Pair& p : etendue.pairs) {
      next[p.j] += 0.5 * p.count * handed[p.i] * x[p.i];
      next[p.i] += 0.5 * p.count * handed[p.j] * x[p.j];
    }
    x.swap(next);
    const double before = sum;
    sum = 0;
    for (size_t i = 0; i < x.size(); ++i) sum += measure[i] * x[i];
    if (bounce >= kFewestBounces && std::abs(sum - before) <= kSettled * sum) break;
  }
  return x;
}

// The sun lights a few bins of the sky. A little of its light is spread over all, so that a window
// counts by all that it sees of the sky.
void spread_sky(const PatchMap& patches, const std::vector<double>& exchanged,
                std::vector<PatchLight>& light) {
  double sum = 0, total = 0;
  for (uint32_t i = 0; i < light.size(); ++i)
    if (patches.is_sky(i)) sum += light[i].brightness * exchanged[i], total += exchanged[i];
  if (!(total > 0)) return;
  for (uint32_t i = 0; i < light.size(); ++i)
    if (patches.is_sky(i))
      light[i].brightness = (1 - kSpread) * light[i].brightness + kSpread * sum / total;
}

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
  // Estimates of small patches are rough: none may hand on more than it has.
  std::vector<double> handed(n, 0), exchanged(n, 0);
  for (const Etendue::Pair& p : etendue.pairs)
    for (const uint32_t end : {p.i, p.j}) exchanged[end] += 0.5 * p.count;
  for (uint32_t i = 0; i < n; ++i)
    if (!patches.is_sky(i) && etendue.samples[i] > 0)
      handed[i] = terms[i].albedo / std::max(etendue.samples[i], exchanged[i]);
  std::vector<double> direct(n), seen(n), measure(n);
  for (size_t i = 0; i < n; ++i)
    direct[i] = terms[i].direct, seen[i] = terms[i].seen, measure[i] = seen[i] * handed[i];
  const std::vector<double> light = transported(etendue, handed, direct, measure);
  double pixels = 0, picture = 0;
  for (size_t i = 0; i < n; ++i) pixels += seen[i], picture += measure[i] * light[i];
  if (!(picture > 0)) return {};
  // Half of each pixel counts by its light, half as much as any other.
  const double mean = picture / pixels;
  double all = 0;
  for (size_t i = 0; i < n; ++i) {
    const double radiosity = handed[i] * light[i];
    seen[i] *= 0.5 / mean + 0.5 / std::max(radiosity, kDarkest * mean);
    all += seen[i] * radiosity;
  }
  for (size_t i = 0; i < n; ++i) measure[i] = direct[i] * handed[i];
  const std::vector<double> importance = transported(etendue, handed, seen, measure);
  std::vector<PatchLight> of_patch(n);
  for (uint32_t i = 0; i < n; ++i) {
    const double samples = patches.is_sky(i) ? exchanged[i] : etendue.samples[i];
    if (!(samples > 0)) continue;
    of_patch[i].brightness = (terms[i].emitted / samples + handed[i] * light[i]) / all;
    of_patch[i].importance = handed[i] * importance[i];
  }
  spread_sky(patches, exchanged, of_patch);
  return of_patch;
}

}  // namespace tdpt
