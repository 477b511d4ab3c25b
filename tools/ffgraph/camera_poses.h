// The poses of a camera that stand for all frames of a shot.
//
// Which openings are narrow changes gradually along the way of a camera, so few poses do: the
// first, each that has moved or turned far enough from the one before it, and the last.
#pragma once
#include <vector>

#include "libcommon/options/shot_options.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// A pose counts if it is this far from the one before it [canonical length, rad]; shares of both
/// add up.
inline constexpr double kMovedFar = 0.25, kTurnedFar = 0.8;

/// On a longer way the poses lie farther apart, since each costs walks and cuts of its own.
inline constexpr size_t kMostPoses = 12;

/// Indices of the poses out of those of all frames, in order.
std::vector<size_t> telling_poses(const std::vector<Camera>& frames);

/// The telling poses of these cameras of the scene in all frames, camera by camera, in the scene's
/// canonical frame, each with the name camera_at_frame(). Throws InputError if more than cameras
/// moves.
std::vector<Camera> camera_poses(SceneFile& file, const Scene& scene,
                                 const std::vector<Camera>& cameras, const ShotArguments& shot);

}  // namespace tdpt
