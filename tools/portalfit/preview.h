// Pictures of fitted portals: over the light to which they were fitted, and in the plans of their
// scene.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/drawing.h"
#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// Views of a portal, metres: `front` from the camera's side along -n, `above` along -up.
struct PortalFrame {
  Vec3d o;             ///< centroid
  Vec3d n, up, right;  ///< unit; n the way the light goes; `up` in the plane, as vertical as it can
};
PortalFrame frame_of(const Portal& portal);

/// Edges that belong to one triangle only.
std::vector<std::array<uint32_t, 2>> outline_of(const Portal& portal);

/// Where a line passes: through this portal, another, or none.
enum class Way { here, elsewhere, nowhere };
struct SeenLine {
  uint32_t line;  ///< index into grid.lines
  Vec3d at;       ///< crossing with the portal's plane, or the line's nearest end [metres]
  Way way;
};
/// The lines to show for portal number `own`: its own, which may end within its wall, and others
/// that cross its plane along the normal. `lines`: by portal, those that it counts, as in
/// fit_portals().
std::vector<SeenLine> lines_to_show(const LightGrid& grid,
                                    const std::vector<std::vector<uint32_t>>& lines, size_t own,
                                    const PortalFrame& frame);

/// A row for each portal (six at most), or for the whole grid if there is none; `why_none` gives
/// the reason. `lines`: as above. `name`: of the grid.
draw::Drawing portal_preview(const LightGrid& grid, const std::vector<Portal>& portals,
                             const std::vector<std::vector<uint32_t>>& lines,
                             const std::string& name, const std::string& why_none);
/// The plan of each storey. What was refused is grey, with its reason.
draw::Drawing plan_preview(const Scene& scene, const Camera& camera, const FitResult& found,
                           const std::string& why_none);
/// glTF: portals translucent, their outlines and normals, and some lines of light.
std::string portal_debug_glb(const LightGrid& grid, const PortalFile& file);

}  // namespace tdpt
