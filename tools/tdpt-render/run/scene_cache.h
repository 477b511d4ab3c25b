// What the command line names, read: scene, sky, camera, size of the picture, portals, and the
// vista that they make. The frames of a shot share its world as far as nothing but the camera moves
// between them.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
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
/// if it has none), 640 wide; if neither is given, first what the scene says. Throws UsageError if
/// too large, InputError if the scene says so.
PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height);

/// Throws UsageError if the film of such a picture takes too much memory [file.h]. With `auto` it
/// may get layers for all techniques of its candidates.
void expect_memory_of_film(const RenderArguments& a, const PictureSize& size);

struct LoadedScene {
  Scene scene;
  Camera camera;
  std::vector<Camera> poses;  ///< of the camera while its shutter is open [CameraBlur]
  double focus = 0;           ///< [m], of a lens, once there is a vista; may be infinite
  PictureSize size;
  std::vector<Portal> portals;
  std::vector<cli::Common::Input> files;
  std::vector<std::string> portal_hashes;  ///< of the portal files
};

/// What the pictures of one command share. Warnings and notes are those of the first picture.
class SceneCache {
 public:
  const std::optional<gpu::Device> device;  ///< that renders; none: the CPU
  explicit SceneCache(std::optional<gpu::Device> device_) : device(std::move(device_)) {}

  /// Reads all of it; the next time, with the same arguments but for the pose and the portals, only
  /// what has changed.
  LoadedScene& load(const RenderArguments& a, const cli::Common& common);

  /// The vista of what was loaded last, with its portals as they were given.
  Vista& vista(const RenderArguments& a, const cli::Common& common);

 private:
  void read(const RenderArguments& a, const cli::Common& common);
  bool only_moves_camera(const RenderArguments& a, const cli::Common& common);
  void take_camera(const RenderArguments& a, const cli::Common& common);
  void take_poses(const RenderArguments& a, const cli::Common& common);
  Lens lens(const LensArguments& a, bool tells, const cli::Common& common);
  void read_portals(const RenderArguments& a, const cli::Common& common);

  std::unique_ptr<SceneFile> file_;
  LoadedScene in_;
  size_t files_but_portals_ = 0;  // of in_.files, the first
  std::optional<Vista> vista_;
  bool first_ = true;    // what is loaded now
  bool showed_ = false;  // a vista
};

/// What a camera is focused on where nobody says it: distance of what stops most of a ray through
/// the middle of the picture, canonical, beyond panes and thin veils. Infinite if nothing does.
double distance_in_the_middle(const World& world, const FilmPlane& film);

// The others from 32 x 32 rays at fixed places of the film.

/// A warning that the camera sees the backs of single-sided surfaces, which glTF viewers do not
/// draw, and most of all of which material; empty if the share is negligible.
std::string backs_sentence(const Vista& vista);

/// Why no sample found light, for a black picture: does the camera see backs alone, as in a wall?
std::string why_black(const Vista& vista);

}  // namespace tdpt
