// Reads the portals given on the command line, and refuses what is no portal of the scene.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct GivenPortals {
  PortalFile file;                    ///< without portals that serve other cameras
  std::vector<std::string> warnings;  ///< sentences
  std::vector<std::string> notes;     ///< sentences about what changes nothing
};

/// Reads a portal file for `scene`. Each portal must be flat [portals.h], have an area and lie in
/// or near the scene; throws InputError for one that does not, for the scene itself and for too
/// many triangles. Left out with a note: those of a file for several cameras that serve others than
/// `camera`. A warning says if the portals were found for other cameras, and a note if they were
/// found at another time.
/// `of_shot`: for a frame of a shot. Portals found for poses of the camera along it are all taken;
/// that they were found at another time is nothing to speak of.
GivenPortals read_given_portals(const std::string& path, const Scene& scene, const Camera& camera,
                                bool of_shot = false);

}  // namespace tdpt
