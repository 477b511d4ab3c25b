// Portals for other renderers, whose portals are rectangles: a text in each one's format, and the
// smallest rectangle around a portal.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/vec.h"

namespace tdpt {

std::vector<std::string> renderer_names();
/// Whether the sky's light meets the portal first, as far as its figure `sky` says. Guiding the
/// sampling of an environment, portals further in are of no use: no text has them.
bool lets_in_sky(const Portal& portal);
/// The text for the renderer of that name:
/// cycles   a Python script for Blender: area lamps as portals. Z up, as by its glTF importer
/// pbrt     a file for pbrt-v4 to Include: an infinite light for each window. Axes of the scene
/// mitsuba  a scene for Mitsuba 3 to include: emitters `portal`. Axes of the scene
/// usd      a layer of OpenUSD, .usda: prims `PortalLight`. Axes of the scene
std::string portals_for(const std::string& renderer, const PortalFile& file);

/// In space [m]. x, y and normal are unit vectors with cross(x, y) = normal, the way the light
/// goes; width is along x, height along y. y is the more vertical side (+Y); in a horizontal
/// rectangle, such as a skylight, x is the longer side.
struct Rectangle {
  std::string name{};  ///< of the portal
  Vec3d centre, x, y, normal;
  double width = 0, height = 0;

  double area() const { return width * height; }
  /// Counter-clockwise seen from where the light goes.
  std::vector<Vec3d> corners() const;
};

/// The rectangle of least area in the portal's plane; its triangles must be planar and have an
/// area.
Rectangle rectangle_of(const Portal& portal);

/// Merges rectangles that face the same way and overlap along their normal: they become the
/// rectangle around both, with both names.
std::vector<Rectangle> without_overlaps(std::vector<Rectangle> rectangles);

}  // namespace tdpt
