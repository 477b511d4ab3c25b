#include "libcommon/scene/uses.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

bool textured(const Material& m) {
  return std::any_of(m.maps.begin(), m.maps.end(), [](const TextureMap& map) { return bool(map); });
}

/// Whether a scene needs a feature, and why: "2 of 5 materials shine".
struct Need {
  bool used;
  std::string reason;
};

/// A feature that some materials need, or something else in a scene.
struct Use {
  std::string_view word;
  const char* saved;  ///< if none needs it
  bool (*which)(const Material&);
  const char* do_what;
  Need (*of_scene)(const Scene&) = nullptr;

  Need need(const Scene& s) const {
    if (of_scene) return of_scene(s);
    const auto n = std::count_if(s.materials.begin(), s.materials.end(), which);
    return {n > 0, fmt::format("{} of {} materials {}", n, s.materials.size(), do_what)};
  }
};

Need need_normals(const Scene& s) {
  const auto n = std::ssize(s.smooth) - std::count(s.smooth.begin(), s.smooth.end(), 0);
  return {n > 0, fmt::format("{} of {} triangles have normals that are not their own", n,
                             s.triangles.size())};
}

Need need_lamps(const Scene& s) {
  return {!s.lights.empty(),
          fmt::format("the scene has {} without surface", counted(s.lights.size(), "lamp"))};
}

Need need_sky(const Scene& s) {
  return {s.sky != nullptr,
          s.sky ? "an environment or a sun is given" : "neither an environment nor a sun is given"};
}

using M = Material;
constexpr Use kUses[] = {
    {"textures", "no look-up", textured, "name an image"},
    {"shading normals", "none is interpolated", nullptr, "", need_normals},
    {"specular", "no microfacets", [](const M& m) { return m.metallic > 0 || m.specular > 0; },
     "shine"},
    {"transmission", "no refraction, no panes", [](const M& m) { return m.transmission > 0; },
     "let light through"},
    {"clear coat", "one layer only", [](const M& m) { return m.coat > 0; }, "have a clear coat"},
    {"sheen", "no fibres", [](const M& m) { return m.sheened(); }, "have a sheen"},
    {"alpha", "no ray asks whether it is covered",
     [](const M& m) { return m.alpha_mode != M::Alpha::opaque; }, "have holes"},
    {"vertex colours", "none is interpolated", [](const M& m) { return m.coloured; },
     "are tinted by their vertices"},
    {"punctual lights", "none is drawn", nullptr, "", need_lamps},
    {"absorption", "no edge asks what it lies in",
     [](const M& m) { return max_component(m.absorption) > 0; }, "absorb light within"},
    {"normal maps", "no look-up",
     [](const M& m) { return m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL]; }, "name one"},
    {"textured emission", "each emitter is even",
     [](const M& m) { return bool(m.maps[MAP_EMISSION]); }, "name one"},
    {"a sky", "what leaves the scene is dropped", nullptr, "", need_sky}};

}  // namespace

std::vector<std::string_view> all_needs() {
  std::vector<std::string_view> words;
  for (const Use& use : kUses) words.push_back(use.word);
  return words;
}

cli::Decisions uses_of(const Scene& scene, const std::vector<std::string_view>& words) {
  cli::Decisions decisions;
  for (const Use& use : kUses) {
    if (std::find(words.begin(), words.end(), use.word) == words.end()) continue;
    const auto [used, reason] = use.need(scene);
    decisions.push_back(
        {std::string(use.word), used ? "used" : "left out", reason, used ? "" : use.saved});
  }
  return decisions;
}

}  // namespace tdpt
