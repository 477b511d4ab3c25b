// Pictures of a network: how strongly walks from the light and from the camera reach each patch.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/scene_sheet.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// What the terminals give a patch, in [0,1]: capacity of source -> patch and of patch -> sink in
/// shares of its samples. With triangles as nodes: 1 in S_d (lit directly) and in S_p (seen by the
/// camera), 0 elsewhere.
struct Reach {
  double light = 0, camera = 0;
};
std::vector<Reach> reach_of_patches(const DimacsFile& file, bool triangles);

/// The surfaces in the colours of their patches' reach (draw::reach).
void paint_network(draw::SceneSheet& sheet, const Scene& scene, const DimacsFile& file,
                   bool triangles);

/// Camera view and plan, patches in the colours of their reach.
draw::Canvas network_preview(const Scene& scene, const Camera& camera, const DimacsFile& file,
                             bool triangles);
/// glTF: a square for every patch, or every triangle, in the same colours.
std::string network_debug_glb(const Scene& scene, const DimacsFile& file, bool triangles);

}  // namespace tdpt
