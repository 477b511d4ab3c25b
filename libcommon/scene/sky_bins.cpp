#include "libcommon/scene/sky_bins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace {

constexpr int kFaces = 20, kSunSamples = 16;
// Directions along a texel's sides; more per texel in small maps, where texels are coarse compared
// with bins.
constexpr int kLeastColumns = 1024, kLeastRows = 512;

struct Bins {
  std::array<std::array<Vec3d, 3>, kFaces> face;
  std::array<std::array<Vec3d, 3>, kSkyBins> bin;  // four for each face, consecutively
};

// Positive if w lies within the cone over the triangle: the smallest of three sines.
double depth_in(const std::array<Vec3d, 3>& t, const Vec3d& w) {
  return std::min(
      {dot(cross(t[1], t[0]), w), dot(cross(t[2], t[1]), w), dot(cross(t[0], t[2]), w)});
}

Bins make_bins() {
  const double g = std::numbers::phi;
  const Vec3d v[] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const int f[kFaces][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  Bins b;
  for (size_t i = 0; i < kFaces; ++i) {
    // Reversed orientation: seen from inside.
    const Vec3d p = normalize(v[f[i][0]]), q = normalize(v[f[i][2]]), r = normalize(v[f[i][1]]);
    const Vec3d pq = normalize(p + q), qr = normalize(q + r), rp = normalize(r + p);
    b.face[i] = {p, q, r};
    b.bin[4 * i] = {p, pq, rp};
    b.bin[4 * i + 1] = {pq, q, qr};
    b.bin[4 * i + 2] = {rp, qr, r};
    b.bin[4 * i + 3] = {pq, qr, rp};
  }
  return b;
}

const Bins& bins() {
  static const Bins all = make_bins();
  return all;
}

void add_map(const Sky& sky, std::vector<double>& light) {
  const Sky::Map& map = sky.map();
  if (map.texels.empty()) return;
  // Subdivides the texels of small maps.
  const int across = std::max(1, kLeastColumns / map.width),
            down = std::max(1, kLeastRows / map.height);
  const double columns = double{1} * map.width * across;
  for (int row = 0; row < map.height; ++row)
    for (int part = 0; part < down; ++part) {
      const double low = (row + static_cast<double>(part) / down) / map.height,
                   high = (row + (part + 1.0) / down) / map.height;
      const double sr = 2 * std::numbers::pi / columns *
                        (std::cos(std::numbers::pi * low) - std::cos(std::numbers::pi * high));
      for (int column = 0; column < map.width; ++column) {
        const double y =
            luminance(map.texels[static_cast<size_t>(row) * static_cast<size_t>(map.width) +
                                 static_cast<size_t>(column)]);
        if (y <= 0) continue;
        for (int k = 0; k < across; ++k)
          light[sky_bin(sky.towards(column + (k + 0.5) / across, row + (part + 0.5) / down))] +=
              y * sr;
      }
    }
}

void add_sun(const Sky::Sun& sun, std::vector<double>& light) {
  const Onb<double> onb(sun.towards);
  const double least = std::cos(sun.half_angle);
  const double sr = 2 * std::numbers::pi * (1 - least) / (kSunSamples * kSunSamples);
  for (int i = 0; i < kSunSamples; ++i)
    for (int k = 0; k < kSunSamples; ++k) {
      const double z = 1 - (i + 0.5) / kSunSamples * (1 - least);
      const double r = std::sqrt(std::max(0.0, 1 - z * z));
      const double phi = 2 * std::numbers::pi * (k + 0.5) / kSunSamples;
      light[sky_bin(onb.to_world({r * std::cos(phi), r * std::sin(phi), z}))] +=
          luminance(sun.radiance) * sr;
    }
}

}  // namespace

const std::array<Vec3d, 3>& sky_bin_corners(uint32_t bin) {
  return bins().bin[bin];
}

Vec3d sky_bin_middle(uint32_t bin) {
  const std::array<Vec3d, 3>& c = sky_bin_corners(bin);
  return normalize(c[0] + c[1] + c[2]);
}

double sky_bin_solid_angle(uint32_t bin) {
  // Van Oosterom and Strackee (1983).
  const std::array<Vec3d, 3>& c = sky_bin_corners(bin);
  return 2 * std::atan2(std::abs(dot(c[0], cross(c[1], c[2]))),
                        1 + dot(c[0], c[1]) + dot(c[1], c[2]) + dot(c[2], c[0]));
}

uint32_t sky_bin(const Vec3d& towards) {
  const Bins& b = bins();
  const auto deepest = [&](const auto& triangles, uint32_t first, uint32_t count) {
    uint32_t best = first;
    double most = -1e300;
    for (uint32_t i = first; i < first + count && most < 0; ++i)
      if (const double depth = depth_in(triangles[i], towards); depth > most)
        most = depth, best = i;
    return best;
  };
  return deepest(b.bin, 4 * deepest(b.face, 0, kFaces), 4);
}

bool lit_from_infinity(const Scene& scene) {
  const auto shines = [](const PunctualLight& l) {
    return l.kind == PunctualLight::Kind::directional && luminance(l.intensity) > 0;
  };
  return std::any_of(scene.lights.begin(), scene.lights.end(), shines) ||
         (scene.sky && !SkyDirections(*scene.sky).empty());
}

std::vector<double> sky_bin_light(const Scene& scene) {
  std::vector<double> light(kSkyBins, 0);
  for (const PunctualLight& l : scene.lights)
    if (l.kind == PunctualLight::Kind::directional)
      light[sky_bin(-l.direction)] += luminance(l.intensity);
  if (!scene.sky) return light;
  add_map(*scene.sky, light);
  for (const Sky::Sun& sun : scene.sky->suns()) add_sun(sun, light);
  return light;
}

}  // namespace tdpt
