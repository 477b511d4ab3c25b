// Portals as the command line gives them, judged before they are used: what cannot be one costs
// nothing but a sentence.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct GivenPortals {
  PortalFile file;                    ///< with the portals that are of use
  std::vector<std::string> warnings;  ///< sentences: portals left out, or changed in their shape
  std::vector<std::string> notes;     ///< of what changes nothing
};

/// Reads a file of portals for `scene`; each is brought into planes [portal_mesh.h]. Left out with
/// a warning: bodies, what is folded, and what lies outside the scene or is far larger than it,
/// with the unit that it seems to be drawn in [portal_fit.h]; where they were found for another
/// camera than `camera`, a warning says so. Throws InputError for a whole scene given by mistake,
/// and for more triangles than any portal has.
GivenPortals read_given_portals(const std::string& path, const Scene& scene, const Camera& camera);

}  // namespace tdpt
