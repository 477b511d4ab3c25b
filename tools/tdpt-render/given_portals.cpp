#include "tools/tdpt-render/given_portals.h"

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt {
namespace {

// Every edge of a path is tested against every triangle of the portals, and places are held in
// single precision by the tracer.
constexpr size_t kMostTriangles = 4096;
constexpr double kFarthest = 1e6;  ///< canonical

void check(const std::string& name, const std::vector<Portal>& portals, const Frame& frame) {
  size_t triangles = 0;
  for (const Portal& portal : portals) {
    triangles += portal.triangles.size();
    for (const Vec3d& v : portal.vertices)
      if (!(length(frame.to_canonical(v)) <= kFarthest))
        throw InputError(name, portal.name, "lies more than a million times the scene's size away");
  }
  if (triangles > kMostTriangles)
    throw InputError(name, "",
                     fmt::format("has {} triangles, expected a portal of at most {}", triangles,
                                 kMostTriangles));
}

}  // namespace

PortalFile read_given_portals(const std::string& path, const Scene& scene) {
  PortalFile file = read_portals(path);
  if (!file.scene_hash.empty() && file.scene_hash != scene.hash)
    throw InputError(display_name(path), "", "was made from another scene than " + scene.path);
  check(display_name(path), file.portals, scene.frame);
  return file;
}

}  // namespace tdpt
