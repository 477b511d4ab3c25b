// The light of the pictures on its way from patch to patch: finite-element radiosity on the
// network, solved once for how bright patches are and once per camera for what they mean to its
// picture.
//
// n_i, n_ij  samples and etendue of patches and pairs [etendue.h]: A_i F_ij ~ n_ij / 2
// D_i        power that reaches patch i straight from lamps and sky (first hits of light walks)
// W_i        what patch i means to a picture: the pixels that show it (first hits of camera
//            walks), half as they are and half each divided by its light. So light that few bright
//            pixels have counts, and light that many dark ones have
// r_i        albedo
//   n_i e_i = D_i + sum_j n_ij/2 r_j e_j     irradiance e_i
//   n_i m_i = W_i + sum_j n_ij/2 r_j m_j     importance m_i, the adjoint
// With E_i the power that patch i itself emits, the share of the picture's light that goes from i
// to j without a surface in between is
//   n_ij/2 b_i v_j,  b_i = (E_i / n_i + r_i e_i) / sum_k W_k r_k e_k,  v_j = r_j m_j.
// What a camera sees of the lamps themselves does not count. All cameras share one b, that of the
// first; v of each is scaled so that the formula gives the share of its own picture's light.
#include "tools/ffgraph/light_flow.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

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

// Solves x_i = begin_i + sum_j n_ij/2 handed_j x_j, x in power, until sum_i measure_i x_i settles,
// for each of the measures.
std::vector<double> transported(const Etendue& etendue, const std::vector<double>& handed,
                                const std::vector<double>& begin,
                                const std::vector<std::vector<double>>& measures) {
  std::vector<double> x = begin, next, sums(measures.size(), 0);
  for (int bounce = 0; bounce < kMostBounces; ++bounce) {
    next = begin;
    for (const Etendue::Pair& p : etendue.pairs) {
      next[p.j] += 0.5 * p.count * handed[p.i] * x[p.i];
      next[p.i] += 0.5 * p.count * handed[p.j] * x[p.j];
    }
    x.swap(next);
    bool settled = bounce >= kFewestBounces;
    for (size_t k = 0; k < measures.size(); ++k) {
      const double before = sums[k];
      sums[k] = std::inner_product(x.begin(), x.end(), measures[k].begin(), 0.0);
      settled &= std::abs(sums[k] - before) <= kSettled * sums[k];
    }
    if (settled) break;
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

namespace {

// What of each patch's light is handed on: albedo per sample. Estimates of small patches are rough:
// none may hand on more than it has.
std::vector<double> handed_on(const PatchMap& patches, const Etendue& etendue,
                              const std::vector<double>& albedo,
                              const std::vector<double>& exchanged) {
  std::vector<double> handed(albedo.size(), 0);
  for (uint32_t i = 0; i < handed.size(); ++i)
    if (!patches.is_sky(i) && etendue.samples[i] > 0)
      handed[i] = albedo[i] / std::max(etendue.samples[i], exchanged[i]);
  return handed;
}

// W of one camera, each pixel counted half by its light and half as much as any other; and the sum
// of its picture's light, counted so.
struct Pixels {
  std::vector<double> seen;
  double all = 0;
};
Pixels pixels_of(std::vector<double> seen, const std::vector<double>& handed,
                 const std::vector<double>& light) {
  double pixels = 0, picture = 0, all = 0;
  for (size_t i = 0; i < seen.size(); ++i)
    pixels += seen[i], picture += seen[i] * handed[i] * light[i];
  if (!(picture > 0)) return {};
  const double mean = picture / pixels;
  for (size_t i = 0; i < seen.size(); ++i) {
    const double radiosity = handed[i] * light[i];
    seen[i] *= 0.5 / mean + 0.5 / std::max(radiosity, kDarkest * mean);
    all += seen[i] * radiosity;
  }
  return {std::move(seen), all};
}

}  // namespace

std::vector<PatchLight> camera_light(const PatchMap& patches, const Etendue& etendue,
                                     const LightTerms& terms) {
  const size_t n = terms.direct.size(), cameras = terms.seen.size();
  std::vector<double> exchanged(n, 0);
  for (const Etendue::Pair& p : etendue.pairs)
    for (const uint32_t end : {p.i, p.j}) exchanged[end] += 0.5 * p.count;
  const std::vector<double> handed = handed_on(patches, etendue, terms.albedo, exchanged);
  const auto times_handed = [&](std::vector<double> of_patches) {
    for (size_t i = 0; i < n; ++i) of_patches[i] *= handed[i];
    return of_patches;
  };
  std::vector<std::vector<double>> measures;
  for (const std::vector<double>& seen : terms.seen) measures.push_back(times_handed(seen));
  const std::vector<double> light = transported(etendue, handed, terms.direct, measures);
  const std::vector<double> of_light = times_handed(terms.direct);
  std::vector<PatchLight> of_patch(n);
  double unit = 0;  // light of the first picture that has any
  for (size_t k = 0; k < cameras; ++k) {
    const Pixels pixels = pixels_of(terms.seen[k], handed, light);
    for (PatchLight& p : of_patch) p.importance.push_back(0);
    if (!(pixels.all > 0)) continue;
    if (unit == 0) unit = pixels.all;
    const std::vector<double> importance = transported(etendue, handed, pixels.seen, {of_light});
    for (uint32_t i = 0; i < n; ++i)
      of_patch[i].importance[k] = handed[i] * importance[i] * (unit / pixels.all);
  }
  if (unit == 0) return {};
  for (uint32_t i = 0; i < n; ++i) {
    const double samples = patches.is_sky(i) ? exchanged[i] : etendue.samples[i];
    if (samples > 0)
      of_patch[i].brightness = (terms.emitted[i] / samples + handed[i] * light[i]) / unit;
  }
  spread_sky(patches, exchanged, of_patch);
  return of_patch;
}

}  // namespace tdpt
