// The pinhole camera as a map between pixels and directions, with its importance.
//
// The film lies at distance 1 in front of the pinhole. A picture of width x height square pixels
// shows the camera's full vertical angle; if its aspect differs from the camera's, yfov is kept.
// Raster coordinates: x to the right from 0 to width, y down from 0 to height.
#pragma once
#include <cmath>

#include "libcommon/scene/scene.h"

namespace tdpt {

class FilmPlane {
 public:
  FilmPlane(const Camera& camera, int width, int height)
      : camera_(camera),
        width_(width),
        height_(height),
        half_height_(std::tan(0.5 * camera.yfov)),
        half_width_(half_height_ * width / height),
        area_(4 * half_width_ * half_height_) {}

  int width() const { return width_; }
  int height() const { return height_; }
  const Vec3d& position() const { return camera_.position; }
  const Vec3d& forward() const { return camera_.forward; }
  const Vec3d& right() const { return camera_.right; }
  const Vec3d& up() const { return camera_.up; }
  /// At distance 1.
  double half_width() const { return half_width_; }
  double half_height() const { return half_height_; }

  /// Unit direction through raster place (x, y).
  Vec3d direction(double x, double y) const {
    const double u = (2 * x / width_ - 1) * half_width_;
    const double v = (1 - 2 * y / height_) * half_height_;
    return normalize(camera_.forward + camera_.right * u + camera_.up * v);
  }

  /// Raster place hit by unit direction `w` (away from the camera); false if it misses the film.
  bool raster(const Vec3d& w, double& x, double& y) const {
    const double c = dot(w, camera_.forward);
    if (!(c > 0)) return false;
    x = 0.5 * width_ * (1 + dot(w, camera_.right) / (c * half_width_));
    y = 0.5 * height_ * (1 - dot(w, camera_.up) / (c * half_height_));
    return x >= 0 && x < width_ && y >= 0 && y < height_;
  }

  /// Density of w for raster places uniform over the whole film [1/sr]: 1 / (film area * cos^3).
  double pdf_w(const Vec3d& w) const {
    const double c = dot(w, camera_.forward);
    return 1 / (area_ * c * c * c);
  }

 private:
  Camera camera_;
  int width_, height_;
  double half_height_, half_width_, area_;
};

}  // namespace tdpt
