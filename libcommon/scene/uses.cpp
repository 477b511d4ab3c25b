#include "libcommon/scene/uses.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

/// Whether something uses a feature, and why: "2 of 5 materials shine".
struct Need {
  bool used;
  std::string reason;
};

Need share(size_t n, size_t of, const char* noun, const char* do_what) {
  return {n > 0, fmt::format("{} of {} {} {}", n, of, noun, do_what)};
}

Need of_materials(const Scene& s, bool (*which)(const Material&), const char* do_what) {
  const auto n = std::count_if(s.materials.begin(), s.materials.end(), which);
  return share(static_cast<size_t>(n), s.materials.size(), "materials", do_what);
}

bool textured(const Material& m) {
  return std::any_of(m.maps.begin(), m.maps.end(), [](const TextureMap& map) { return bool(map); });
}

/// A feature, whether a scene needs it, and what is saved if not.
struct Use {
  std::string_view word;
  Need (*need)(const Scene&);
  const char* saved;
};

constexpr std::array kUses{
    Use{"textures", [](const Scene& s) { return of_materials(s, textured, "name an image"); },
        "no look-up"},
    Use{"shading normals",
        [](const Scene& s) {
          const auto flat = std::count(s.smooth.begin(), s.smooth.end(), 0);
          return share(s.smooth.size() - static_cast<size_t>(flat), s.triangles.size(), "triangles",
                       "have normals that are not their own");
        },
        "none is interpolated"},
    Use{"specular",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.metallic > 0 || m.specular > 0; }, "shine");
        },
        "no microfacets"},
    Use{"transmission",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.transmission > 0; }, "let light through");
        },
        "no refraction, no panes"},
    Use{"clear coat",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.coat > 0; }, "have a clear coat");
        },
        "one layer only"},
    Use{"sheen",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.sheened(); }, "have a sheen");
        },
        "no fibres"},
    Use{"alpha",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.alpha_mode != Material::Alpha::opaque; },
              "have holes");
        },
        "no ray asks whether it is covered"},
    Use{"vertex colours",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.coloured; }, "are tinted by their vertices");
        },
        "none is interpolated"},
    Use{"punctual lights",
        [](const Scene& s) {
          return Need{!s.lights.empty(), fmt::format("the scene has {} without surface",
                                                     counted(s.lights.size(), "lamp"))};
        },
        "none is drawn"},
    Use{"absorption",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return max_component(m.absorption) > 0; },
              "absorb light within");
        },
        "no edge asks what it lies in"},
    Use{"normal maps",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL]; },
              "name one");
        },
        "no look-up"},
    Use{"textured emission",
        [](const Scene& s) {
          return of_materials(
              s, [](const Material& m) { return bool(m.maps[MAP_EMISSION]); }, "name one");
        },
        "each emitter is even"},
    Use{"a sky",
        [](const Scene& s) {
          return Need{s.sky != nullptr, s.sky ? "an environment or a sun is given"
                                              : "neither an environment nor a sun is given"};
        },
        "what leaves the scene is dropped"}};

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
