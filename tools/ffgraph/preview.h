// Pictures of a network: how strongly light walks and camera walks reach each patch.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/drawing.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Data terms of a patch, in [0,1]: capacities of source -> patch and patch -> sink as shares of
/// its samples. With triangles as nodes: 1 in S_d (lit directly) and in S_p (seen by the camera), 0
/// elsewhere.
struct Reach {
  double light = 0, camera = 0;
};
std::vector<Reach> reach_of_patches(const DimacsFile& file, bool triangles);

/// Camera view and plan, with patches coloured by their reach (draw::reach).
draw::Drawing network_preview(const Scene& scene, const Camera& camera, const DimacsFile& file,
                              bool triangles);
/// glTF: a square for every patch, or every triangle, in the same colours.
std::string network_debug_glb(const Scene& scene, const DimacsFile& file, bool triangles);

}  // namespace tdpt
