// What the command line names, read: scene, sky, camera, size of the picture, portals, and the
// vista that they make. The frames of a shot share its world as far as nothing but the camera moves
// between them.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/gpu/device.h"
#include "libcommon/scene/scene.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt {

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};

/// Fills in what `width` and `height` leave open as 0: square pixels, the camera's aspect (16 : 9
/// if it has none), 640 wide. Throws UsageError if too large.
PictureSize picture_size(const Camera& camera, int64_t width, int64_t height);

/// If neither is given, takes what the scene says, and fills in the rest as above. Throws
/// InputError if that is too large.
PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height);

/// Throws UsageError if the film of such a picture takes too much memory [file.h]. With `auto` it
/// may get layers for all techniques of its candidates.
void expect_memory_of_film(const RenderArguments& a, const PictureSize& size);

struct Loaded {
  Scene scene;
  TakenSky sky;
  Camera camera;
  std::vector<Camera> poses;  ///< of the camera while its shutter is open [CameraBlur]
  LensArguments lens;
  double focus = 0;  ///< [m], of a lens, once there is a vista; may be infinite
  PictureSize size;
  std::vector<Portal> portals;
  std::vector<cli::Common::Input> files;
  std::vector<std::string> portal_hashes;  ///< of the portal files
};

/// What the pictures of one command share.
class Scenery {
 public:
  const std::optional<gpu::Device> device;  ///< that renders; none: the CPU
  explicit Scenery(std::optional<gpu::Device> device_) : device(std::move(device_)) {}

  /// Reads all of it; the next time, with the same arguments but for the pose and the portals, only
  /// what has changed. Warnings and notes of the scene are printed the first time.
  Loaded& load(const RenderArguments& a, const cli::Common& common);

  /// The vista of what was loaded last, with its portals as they were given.
  Vista& vista(const cli::Common& common);

 private:
  void read(const RenderArguments& a, const cli::Common& common, bool tells);
  bool only_moves_camera(const RenderArguments& a, const cli::Common& common);
  void take_camera(const RenderArguments& a, const cli::Common& common);
  void take_poses(const RenderArguments& a, const cli::Common& common);
  Lens lens(const cli::Common& common);
  void read_portals(const RenderArguments& a, const cli::Common& common);
  void warn_of_backs(const cli::Common& common);

  std::unique_ptr<SceneFile> file_;
  Loaded in_;
  size_t files_but_portals_ = 0;  // of in_.files, the first
  std::optional<Vista> vista_;
  std::set<std::string> reported_;  ///< what is reported of the first picture alone
  bool shows_backs_ = false;        ///< the last camera did, and a warning said so
};

}  // namespace tdpt
