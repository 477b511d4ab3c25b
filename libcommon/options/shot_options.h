// The command-line options that select a moment of the scene's animations, or a shot, the same in
// every program that reads a scene. A shot is frames at equal steps of time, each a picture with a
// number in its files' names.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// --at, --animation.
void declare_pose_options(cli::Options& options, Pose& pose,
                          cli::Effect effect = cli::Effect::picture);

inline constexpr int64_t kLastFrame = 1000000;

struct ShotArguments {
  std::string frames;  ///< "A-B" or "A"; empty: no shot
  double fps = 24;     ///< frames per second
  bool is_given() const { return !frames.empty(); }
};

/// --frames, --fps. `frames`: what --frames changes.
void declare_shot_options(cli::Options& options, ShotArguments& a,
                          cli::Effect frames = cli::Effect::picture);

/// Frames from `first` to `last`, both included. Frame K shows the scene K / fps seconds after time
/// 0, as modelling programs count.
struct FrameRange {
  int64_t first = 0, last = 0;
  int64_t count() const { return last - first + 1; }
};
/// "A-B", or "A" of one.
std::string words_of(const FrameRange& frames);
/// Reads ShotArguments::frames. Throws UsageError.
FrameRange frame_range(const ShotArguments& a);

/// Throws UsageError for options that contradict each other.
void check_shot(const ShotArguments& a, const Pose& pose);

/// Whether there is a # in the file's name.
bool has_frame_number(const std::string& pattern);
/// The name of a frame's file: "shot.0012.exr" for "shot.####.exr". Throws UsageError, naming
/// `option`, if there is no # in the file's name.
std::string name_of_frame(const std::string& option, const std::string& pattern, int64_t frame);

/// The name of a camera as it stands at a frame, in files made for several: "walk, frame 12".
std::string camera_at_frame(const std::string& camera, int64_t frame);
/// The frame of such a name; nothing for the name of another camera, or of none at a frame.
std::optional<int64_t> frame_of_camera(const std::string& name, const std::string& camera);

}  // namespace tdpt
