// Pictures of fitted portals over the light they were fitted to.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/canvas.h"
#include "libcommon/formats/debug_glb.h"
#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"

namespace tdpt {

/// How a portal is looked at, metres: `front` from the camera's side along -n, `above` along -up.
struct PortalFrame {
  Vec3d o;             ///< middle of its area
  Vec3d n, up, right;  ///< unit; n the way the light goes; `up` in the plane, as upright as can be
};
PortalFrame frame_of(const Portal& portal);

/// Edges that belong to one triangle only.
std::vector<std::array<uint32_t, 2>> outline_of(const Portal& portal);

/// Where a line goes: through this portal, through another, through none.
enum class Way { here, elsewhere, nowhere };
struct SeenLine {
  uint32_t line;  ///< of grid.lines
  Vec3d at;       ///< where it crosses the portal's plane, or its end nearest to that [metres]
  Way way;
};
/// The lines to show with portal number `own`: its own lines, which may end within its wall, and
/// the others that cross its plane along the normal. `lines`: of each portal those that it counts,
/// as fit_portals() says.
std::vector<SeenLine> lines_to_show(const LightGrid& grid,
                                    const std::vector<std::vector<uint32_t>>& lines, size_t own,
                                    const PortalFrame& frame);

/// A row for each portal (six at most) or for the whole grid where there is none; `why_none`
/// says why. `lines`: as above. `name`: of the grid.
draw::Canvas portal_preview(const LightGrid& grid, const std::vector<Portal>& portals,
                            const std::vector<std::vector<uint32_t>>& lines,
                            const std::string& name, const std::string& why_none);
/// glTF: portals translucent, their outlines and normals, and some lines of light.
std::string portal_debug_glb(const LightGrid& grid, const PortalFile& file, DebugLines lines);

}  // namespace tdpt
