// Portals as the command line gives them, held against the scene before they are used.
#pragma once
#include <string>

#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Reads a file of portals for `scene`. Throws InputError when it was made from another scene, when
/// a vertex lies more than a million times the scene's size away, and for more triangles than any
/// portal has: a whole scene given as a portal by mistake is told so.
PortalFile read_given_portals(const std::string& path, const Scene& scene);

}  // namespace tdpt
