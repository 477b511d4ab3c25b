// Portals for other renderers, whose portals are rectangles: a text in each one's format.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt {

std::vector<std::string> renderer_names();
/// Whether the sky's light meets the portal first, as far as its figure `sky` says.
bool lets_in_sky(const Portal& portal);
/// The text for the renderer of that name:
/// cycles   a Python script for Blender: area lamps as portals. Z up, as by its glTF importer
/// pbrt     a file for pbrt-v4 to Include: an infinite light for each window. Axes of the scene
/// mitsuba  a scene for Mitsuba 3 to include: emitters `portal`. Axes of the scene
/// usd      a layer of OpenUSD, .usda: prims `PortalLight`. Axes of the scene
std::string portals_for(const std::string& renderer, const PortalFile& file);

}  // namespace tdpt
