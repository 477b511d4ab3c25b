// The poses of a camera that stand for all frames of a shot.
//
// Which openings are narrow changes gradually along the way of a camera, so few poses do: the
// first, each that has moved or turned far enough from the one before it, and the last.
#pragma once
#include <string>
#include <vector>

#include "libcommon/options/shot_options.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// A pose that is so far from the one before it counts [canonical length, rad]: shares of both add
/// up.
inline constexpr double kMovedFar = 0.25, kTurnedFar = 0.8;

/// Of a longer way they lie farther apart: each costs walks and cuts of its own.
inline constexpr size_t kMostPoses = 12;

/// Indices of the poses out of those of all frames, in order.
std::vector<size_t> telling_poses(const std::vector<Camera>& frames);

/// Throws InputError if more than cameras moves in these frames.
void check_stands_still(SceneFile& file, const Scene& scene, const ShotArguments& shot);

/// The telling poses of a camera of the scene in these frames, in the scene's canonical frame, each
/// with the name camera_at_frame(). `name`: of the camera.
std::vector<Camera> camera_poses(SceneFile& file, const Scene& scene, const std::string& name,
                                 const ShotArguments& shot);

}  // namespace tdpt
