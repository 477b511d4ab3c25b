// Reads the portals given on the command line and checks them: geometry that cannot be a portal is
// left out with a warning.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct GivenPortals {
  PortalFile file;                    ///< with the usable portals only
  std::vector<std::string> warnings;  ///< sentences about portals left out or reshaped
  std::vector<std::string> notes;     ///< sentences about what changes nothing
};

/// Reads a portal file for `scene`; each portal is flattened into planes [portal_mesh.h]. Left out
/// with a warning: closed bodies, folded meshes, and portals outside the scene or far larger than
/// it; the warning names the unit it seems drawn in [portal_fit.h]. Left out with a note: those of
/// a file for several cameras that serve others than `camera`. A warning also says if the portals
/// were found for other cameras, and a note if they were found at another time. Throws InputError
/// for a whole scene given by mistake, and for more triangles than any portal has.
/// `frame`: of a shot. Portals found for poses of the camera along it are all taken; that they were
/// found at another time is nothing to speak of.
GivenPortals read_given_portals(const std::string& path, const Scene& scene, const Camera& camera,
                                std::optional<int64_t> frame = {});

}  // namespace tdpt
