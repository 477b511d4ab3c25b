// A described scene as a .glb, and its environment beside it.
#pragma once
#include <string>

#include "libcommon/base/provenance.h"
#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

enum class Up { by_camera, x, y, z };

/// The frame in which a scene is written: right-handed, +y up, as glTF wants it.
struct Frame {
  Affine to_gltf{};       ///< orthogonal; of the source's coordinates
  bool mirrored = false;  ///< the source's frame is left-handed
  Up up = Up::y;          ///< what is up in the source; never by_camera
  bool downwards = false;
};

struct Writing {
  Up up = Up::by_camera;
  int longest_texture = 0;  ///< 0: of any size
  std::string environment;  ///< name of the file beside the scene, without suffix
  std::string format;       ///< of the source, such as "Tungsten"
  Provenance provenance{};
};

struct Written {
  std::string glb;
  std::string environment, environment_suffix;  ///< its bytes; empty: there is no such file
  std::string portals;                          ///< a file of portals; empty: there are none
  Frame frame;
  size_t triangles = 0, shapes = 0, materials = 0, textures = 0, emitters = 0;
};

/// Names what glTF cannot hold as lost.
Written written(const Described& scene, const Writing& writing, Source& source);

}  // namespace tdpt::foreign
