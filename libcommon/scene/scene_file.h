// A scene file that is read once and posed as often as wanted.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt {

class SceneFile {
 public:
  /// Reads and checks the file. `animations`: names of those that are applied; empty: all. Throws
  /// InputError as read_gltf().
  SceneFile(const std::string& path, const std::vector<std::string>& animations);
  ~SceneFile();

  /// The scene at this time [s]; none: its beginning, with a warning if something moves.
  Scene at(std::optional<double> seconds);

  /// What may be known of a moment without reading a mesh.
  struct Glance {
    std::string pose_hash;        ///< Scene::pose_hash
    std::vector<Camera> cameras;  ///< those of the scene at that time, positions in metres
  };
  Glance glance_at(double seconds);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tdpt
