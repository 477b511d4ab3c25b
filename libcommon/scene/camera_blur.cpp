#include "libcommon/scene/camera_blur.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt {

FilmPlane CameraBlur::draw(const FilmPlane& film, double u, double v, double time) const {
  FilmPlane drawn = poses_.empty() ? film : film.moved_to(pose_at(time));
  if (lens_.radius == 0) return drawn;
  const double r = lens_.radius * std::sqrt(u), angle = 2 * std::numbers::pi * v;
  return drawn.through(r * std::cos(angle), r * std::sin(angle), lens_.focus);
}

Camera CameraBlur::pose_at(double time) const {
  const double at = time * static_cast<double>(poses_.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), poses_.size() - 2);
  const Camera &a = poses_[i], &b = poses_[i + 1];
  const double s = at - static_cast<double>(i);
  const auto mixed = [s](const Vec3d& from, const Vec3d& to) { return from + (to - from) * s; };
  Camera pose;
  pose.position = mixed(a.position, b.position);
  pose.forward = normalize(mixed(a.forward, b.forward));
  pose.right = normalize(cross(pose.forward, mixed(a.up, b.up)));
  pose.up = cross(pose.right, pose.forward);
  return pose;
}

}  // namespace tdpt
