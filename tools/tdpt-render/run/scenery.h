// What the command line names, read: scene, sky, camera, portals, and the world that they make. The
// frames of a shot share it as far as nothing but the camera moves between them.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene_file.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/picture_size.h"

namespace tdpt {

struct Loaded {
  Scene scene;
  TakenSky sky;
  Camera camera;
  std::vector<Camera> poses;  ///< of the camera while its shutter is open [CameraBlur]
  LensArguments lens;
  double focus = 0;  ///< [m], of a lens, once there is a world; may be infinite
  PictureSize size;
  std::vector<Portal> portals;
  std::vector<cli::Common::Input> files;
  std::vector<std::string> portal_hashes;  ///< of the portal files
};

class Scenery {
 public:
  /// Reads all of it; the next time, with the same arguments but for the pose and the frame, only
  /// what has changed. Warnings and notes of the scene are printed the first time.
  Loaded& load(const Arguments& a, const cli::Common& common);

  /// What the camera sees and from where, in a word, also while its shutter is open: frames whose
  /// words are equal show the same. Of the scene that was loaded.
  std::string moment(const Arguments& a);

  /// The world of what was loaded last, with its portals as they were given.
  World& world(const cli::Common& common);

 private:
  void read(const Arguments& a, const cli::Common& common, bool tells);
  bool only_moves_camera(const Arguments& a, const cli::Common& common);
  void take_camera(const Arguments& a, const cli::Common& common);
  void take_poses(const Arguments& a, const cli::Common& common);
  Lens lens(const cli::Common& common);
  void read_portals(const Arguments& a, const cli::Common& common);
  void tell_of_backs(const cli::Common& common);

  std::unique_ptr<SceneFile> file_;
  Loaded in_;
  size_t files_but_portals_ = 0;  // of in_.files, the first
  std::unique_ptr<World> world_;
  bool told_ = false;         ///< of covered lamps
  bool told_focus_ = false;   ///< what is in focus
  bool told_stand_ = false;   ///< that the camera of a shutter does
  bool told_motion_ = false;  ///< of motion that no shutter blurs
  bool shows_backs_ = false;  ///< the camera of the last world did, and a warning said so
};

}  // namespace tdpt
