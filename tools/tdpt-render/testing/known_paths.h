// For tests: compares every path that the techniques of an integrator make in two rooms with the
// oracle.
#pragma once
#include <gtest/gtest.h>

#include <optional>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/oracle.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt {

struct Worst {
  double weight = 0;     ///< largest difference of the weights, balance heuristic
  double power = 0;      ///< the same for the power heuristic
  double power_1_9 = 0;  ///< twin: the oracle's exponent is 1.9 instead
  double value = 0;      ///< largest relative error of value * times * p against the contribution
  std::array<int, kTechniques> paths{}, sky{};  ///< number by technique; of those, paths that begin
                                                ///< in the sky
  int dirac = 0, lamps = 0;   ///< paths with a Dirac lobe; paths that begin at a lamp
  int all = 0, off = 0;       ///< paths, and those off by 1 % of their value or 0.001 in weight
  int short_ones = 0;         ///< paths with an edge that rounding may turn: not compared
  int in_planes = 0;          ///< paths with a vertex in a portal's plane: not compared
  int longest = 0, deep = 0;  ///< edges of the longest path; paths of 12 or more
};

inline Scene diffuse_rooms() {
  return read_gltf(two_rooms_path());
}

// The same rooms: materials vary by triangle, with bent normals, and there are lamps of each kind
// besides the emitter, which shines on both sides and reflects as a mirror.
inline Scene glossy_rooms() {
  Scene scene = read_gltf(two_rooms_path());
  std::vector<Material> makes(8);
  for (Material& m : makes) m.plain = false;
  makes[0].plain = true;
  makes[1].specular = 1, makes[1].roughness = 0.5f;  // rough plastic
  makes[2].specular = 1, makes[2].roughness = 0;     // smooth plastic
  makes[3].metallic = 1, makes[3].roughness = 0.4f;  // rough metal
  makes[4].metallic = 1, makes[4].roughness = 0;     // mirror
  makes[5].transmission = 1, makes[5].solid = true, makes[5].specular = 1, makes[5].roughness = 0;
  makes[6] = makes[5], makes[6].roughness = 0.4f;                                  // rough glass
  makes[7].transmission = 0.5f, makes[7].specular = 1, makes[7].roughness = 0.3f;  // thin sheet
  const auto first = static_cast<uint32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), makes.begin(), makes.end());
  scene.smooth.assign(scene.triangles.size(), 1);
  scene.normals.resize(scene.positions.size());
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    Triangle& triangle = scene.triangles[t];
    if (Material& m = scene.materials[triangle.material]; max_component(m.emission) > 0) {
      m.plain = false;
      m.double_sided = true;
      m.base_color = Rgb(0.3f), m.metallic = 1, m.roughness = 0;
      continue;
    }
    triangle.material = first + mix64(t) % 8;
    scene.smooth[t] = t % 2;
    for (uint32_t v : triangle.vertex)
      scene.normals[v] = Vec3f(normalize(shape_of(scene, t).normal + Vec3d(0.2, 0.1, -0.1)));
  }
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({3, 1, 0.3});
  lamp.intensity = Rgb(0.05f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::spot;
  lamp.direction = normalize(Vec3d(-1, -1, 0.5));
  lamp.cos_inner = 0.95, lamp.cos_outer = 0.7;
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  scene.lights.push_back(lamp);
  return scene;
}

// The same under clear coats with tilted normals, some of them smooth, and with sheens; the emitter
// too.
inline Scene coated_rooms() {
  Scene scene = glossy_rooms();
  scene.images.push_back({1, 1, {170, 100, 230, 255}});  // a normal
  scene.uv[0].resize(scene.positions.size());
  scene.tangents.assign(scene.positions.size(), {0.6f, 0.64f, 0.48f, 1});
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    m.plain = false;
    m.coat = i % 4 == 3 ? 0 : 1 - 0.1f * static_cast<float>(i % 5);
    m.coat_roughness = i % 2 == 0 ? 0 : 0.3f + 0.05f * static_cast<float>(i % 7);
    if (i % 3 != 0) m.maps[MAP_COAT_NORMAL].image = 0;
    if (i % 3 != 1) m.sheen_color = {0.6f, 0.4f, 0.3f}, m.sheen_roughness = 0.5f;
  }
  return scene;
}

inline bool has_short_edge(const Path& path) {
  double least = 1;
  for (int i = 0; i < path.k(); ++i)
    least = std::min(least, between(path.vertex(i), path.vertex(i + 1)).d2);
  return least < 1e-10;  // canonical
}

// Whether a vertex, on the rim of a hole, is so near a portal's plane that its edges do not count
// as crossing it [PortalSet::kPortalMargin], which the oracle ignores.
inline bool touches_a_portals_plane(const Vista& vista, const Path& path) {
  for (int i = 0; i <= path.k(); ++i) {
    if (path.vertex(i).at_infinity()) continue;
    for (size_t q = 0; q < vista.openings.portals.size(); ++q) {
      const PortalSet::Polygon& polygon = vista.openings.portals.polygon(static_cast<int>(q));
      const double height = dot(polygon.normal, path.vertex(i).position - polygon.p0);
      if (std::abs(height) < 2 * PortalSet::kPortalMargin) return true;
    }
  }
  return false;
}

/// NaN makes it infinite.
inline void grow(double& largest, double difference) {
  if (!(std::abs(difference) <= largest))
    largest = std::isnan(difference) ? HUGE_VAL : std::abs(difference);
}

inline Worst compare(const Scene& scene, const Integrator& integrator, oracle::Fault fault,
                     int max_depth = 6, uint64_t spp = 64,
                     const std::vector<Portal>& portals = two_crossing_portals(),
                     const CameraBlur& blur = {}) {
  Vista vista(scene, scene.camera(""), 16, 12, portals);
  vista.view.blur = blur;
  Film film(16, 12, 1);
  Tally tally;
  Worst worst;
  std::optional<oracle::SkyLight> sky;
  if (scene.sky) sky.emplace(vista);
  const PathObserver observer = [&](const Contribution& found) {
    const auto& [path, strategy, value, times] = found;
    ++worst.paths[static_cast<size_t>(strategy.technique)];
    worst.longest = std::max(worst.longest, path.k());
    worst.deep += path.k() >= 12;
    worst.lamps += !path.vertex(0).on_surface();
    worst.sky[static_cast<size_t>(strategy.technique)] +=
        path.vertex(0).at_infinity() && path.vertex(0).met();
    bool dirac = false;
    for (int i = 1; i < path.k(); ++i) dirac |= path.dirac(i);
    worst.dirac += dirac;
    worst.short_ones += has_short_edge(path);
    if (has_short_edge(path)) return;
    if (touches_a_portals_plane(vista, path)) {
      ++worst.in_planes;
      return;
    }
    const auto p = oracle::densities(vista, path, integrator.mixture, fault, sky ? &*sky : nullptr);
    const auto weight = [&](double beta) {
      return path.weight(integrator.mixture, strategy, beta);
    };
    const double weight_off = std::abs(weight(1) - oracle::weight(p, strategy, 1));
    grow(worst.weight, weight_off);
    grow(worst.power, weight(2) - oracle::weight(p, strategy, 2));
    grow(worst.power_1_9, weight(2) - oracle::weight(p, strategy, 1.9));
    for (const auto& d : p) {
      if (d.strategy.technique != strategy.technique || d.strategy.split != strategy.split)
        continue;
      const double expected = max_component(oracle::contribution(path));
      // For one sample of the strategy.
      const double p_s = std::exp(d.log_p) / integrator.mixture.samples_of(
                                                 strategy.technique, strategy.split, path.k());
      const double relative = max_component(value) * times * p_s / expected - 1;
      ++worst.all;
      worst.off += std::abs(relative) > 0.01 || weight_off > 1e-3;
      worst.value = std::max(worst.value, std::abs(relative));
    }
  };
  const Variant variant(integrator);
  PathSampler sampler(vista, variant.settings(max_depth, 11), film, tally, &observer);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      for (uint64_t s = 0; s < spp; ++s) variant.sample(sampler, x, y, s);
  EXPECT_LE(worst.in_planes, worst.all / 100);
  return worst;
}

// Paths of walks with one guiding, or none, weighed for another one: number of weights that differ
// from the oracle's. `told`: the mixture that the oracle is asked for.
inline int weighed_as_others(const Scene& scene, const Integrator& made, const Mixture& asked,
                             const Mixture& told,
                             const std::vector<Portal>& portals = two_crossing_portals()) {
  const Vista vista(scene, scene.camera(""), 16, 12, portals);
  Film film(16, 12, 1);
  Tally tally;
  const Guide guide = Guide::knowing_all(vista, made.mixture);
  const Guide other = Guide::knowing_all(vista, asked);
  int all = 0, off = 0;
  WalkDensities plain, directed;
  std::optional<oracle::SkyLight> sky;
  if (scene.sky) sky.emplace(vista);
  const PathObserver observer = [&](const Contribution& found) {
    const auto& [path, strategy, value, times] = found;
    if (path.k() < 2 || !asked.has(strategy.technique)) return;
    path.plain_densities(vista, plain);
    path.directed_densities(other, plain, directed);
    const StrategySums sums = path.sums(asked, directed, plain, strategy);
    const auto [technique, split] = strategy;
    const double per_sample = asked.sample_weight(technique, split, path.k()) /
                              asked.samples_of(technique, split, path.k());
    const double weight = oracle::weight(
        oracle::densities(vista, path, told, oracle::Fault::none, sky ? &*sky : nullptr), strategy,
        1);
    ++all;
    off += std::abs(sums.used * per_sample / sums.counted - weight) > 1e-4;
  };
  PathSampler sampler(vista, {made.mixture, 6, 1, 5, made.stream}, guide, film, tally, &observer);
  for (uint64_t s = 0; s < 3000; ++s) sampler.sample(8, 6, s);
  EXPECT_GT(all, 25);
  return off;
}

}  // namespace tdpt
