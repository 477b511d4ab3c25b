// Portals for other renderers, whose portals are rectangles: a text in each one's format.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt {

/// A Python script for Blender: area lamps as portals. Z up, as by Blender's glTF importer.
std::string portals_for_cycles(const PortalFile& file);
/// A file for pbrt-v4 to Include: an infinite light for each window. Axes of the scene.
std::string portals_for_pbrt(const PortalFile& file);
/// A scene for Mitsuba 3 to include: emitters `portal`. Axes of the scene.
std::string portals_for_mitsuba(const PortalFile& file);
/// A layer of OpenUSD, .usda: prims `PortalLight`. Axes of the scene.
std::string portals_for_usd(const PortalFile& file);

struct Renderer {
  const char* name;
  std::string (*text)(const PortalFile&);
};
inline constexpr Renderer kRenderers[] = {{"cycles", portals_for_cycles},
                                          {"pbrt", portals_for_pbrt},
                                          {"mitsuba", portals_for_mitsuba},
                                          {"usd", portals_for_usd}};
std::vector<std::string> renderer_names();
/// Whether the sky's light meets the portal first, as far as its figure `sky` says.
bool lets_in_sky(const Portal& portal);
/// The text for the renderer of that name.
std::string portals_for(const std::string& renderer, const PortalFile& file);

}  // namespace tdpt
