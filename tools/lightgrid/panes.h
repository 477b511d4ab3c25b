// The sheets of solid glass in a scene's windows.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Solids of glass between two parallel planes that are less than half as thick as wide; glass that
/// is curved or a sheet without thickness is none. The largest first, at most kMostPanes. Faces
/// must point out of the glass.
std::vector<Pane> solid_panes(const Scene& scene);

}  // namespace tdpt
