// The environment of a scene as a file beside it and the keys that name it.
#pragma once
#include <string>

#include "tools/tdpt-import/gltf/buffer.h"
#include "tools/tdpt-import/gltf/writer.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

struct WrittenSky {
  std::string suffix, bytes;             ///< of the file, ".exr" or ".hdr"; empty: the keys say all
  GltfJson extras = GltfJson::object();  ///< keys of the scene's extras but the name of the file
};

/// A map that only has to be turned about +y is copied; any other is resampled in the scene's
/// frame. Empty extras: there is no light.
WrittenSky written_sky(const Described& scene, const Frame& frame, Source& source);

}  // namespace tdpt::foreign
