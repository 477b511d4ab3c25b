// Everything kernels know of a vista, as flat tables.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "libcommon/scene/surface_tables.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/path/lights_layout.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/path/tables.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

// Weights as integers, from which kernels sample with exactly the probability they report
// [shaders/shared/path/sky.h].

/// n + 1 bounds in 0 ... units: entry i of n has the integers in [bound i, bound i+1), in
/// proportion to its weight to within rounding, and at least one if the weight is not 0. Some
/// weight must not be 0, and at most `units` of them.
std::vector<uint64_t> whole_shares(const std::vector<double>& weights, uint64_t units);

/// Appends to `words` a table that divides all 2^32 words by `weights`: where each entry begins,
/// then a guide table for the search.
struct WordTable {
  uint32_t begin = 0, guide = 0, entries = 0;
  uint64_t words_of(const std::vector<uint32_t>& words, uint32_t entry) const;
};
WordTable add_word_table(const std::vector<double>& weights, std::vector<uint32_t>& words);

// The lights of a vista in the layout of shaders/shared/path/lights_layout.h, for a device or for
// the scalar build of its kernels.

/// No vector is empty, since no buffer may be.
struct LightTables {
  shader::LightSettings settings{};
  std::vector<uint32_t> words;
  std::vector<shader::Emitter> emitters;
  std::vector<shader::Lamp> lamps;
  std::vector<shader::SkySun> suns;
  std::vector<shader::SkyTexel> texels;
  std::vector<shader::RectLight> rect_lights;
  std::vector<shader::SkyWindow> windows;
  std::vector<shader::WindowFrame> frames;

  // Features for which kernels are specialised.
  bool has_sky = false;
  bool has_sky_map = false;  ///< of more than one colour
  bool has_lamps = false;
  bool has_rect_lights = false;
  bool has_windows = false;
  bool prefers = false;  ///< light walks prefer some directions of the sky
};

/// Radiance is divided by `radiance_unit`.
LightTables make_light_tables(const Vista& vista, double radiance_unit);

// Portals as tables for kernels and their scalar build [shaders/shared/path/portal_layout.h].

/// All empty, and `guiding` 0, if there are no portals.
struct PortalTables {
  PortalTables() = default;
  explicit PortalTables(const PortalSet& set);

  std::vector<shader::PortalFacet> facets;
  std::vector<shader::PortalPolygon> polygons;
  std::vector<shader::PortalCorner> corners;
  std::vector<shader::PortalPair> pairs;
  shader::GuideParameters guiding{};
};

// Part of make_light_tables(): the sky and its windows.

/// Needs a sky.
void add_sky(const Vista& vista, double radiance_unit, LightTables& tables);
/// Adds the part of the sky that each window shows, if there are windows.
void add_windows(const WindowSky& windows, double radiance_unit, LightTables& tables);

/// All of a vista.
struct RenderTables {
  explicit RenderTables(const Vista& vista);
  /// Takes over the openings of `vista`; its world must be the same.
  void follow(const Vista& vista);

  double radiance_unit;  ///< divisor of radiance in the tables, a power of two
  SurfaceTables surfaces;
  std::vector<float> surface_curves, sheen_curves;  ///< the latter if there is sheen
  LightTables lights;
  PortalTables portals;
  Bvh bvh;
};

namespace shader {
/// Each table of a scene, by the name that kernels use.
struct SceneSpans {
  explicit SceneSpans(const RenderTables& tables);
#define SPAN(type, name, array) std::span<const type> array;
  SCENE_TABLES(SPAN)
#undef SPAN
};
}  // namespace shader

}  // namespace tdpt
