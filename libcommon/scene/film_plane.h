// A pinhole camera as a map between pixels and directions, with its importance; also what one point
// of a lens sees at one moment.
//
// The film lies at distance 1 in front of the pinhole. A picture of width x height square pixels
// shows the camera's full vertical angle; if its aspect differs from the camera's, yfov is kept.
// Raster coordinates: x to the right from 0 to width, y down from 0 to height.
//
// A point of a thin lens is a pinhole beside the middle one, with its film shifted, so that both
// show the plane in focus at the same pixels:
//
//   x = w.right / (h w.forward) + L.right / (h f)     and likewise up
//
// x  place on the film from its middle, in half widths   h  half the width of the film
// L  point of the lens from the pinhole                  f  distance of the plane in focus
//
// Every pixel has the same area of that plane and of
// the film, so the density of directions is the same function of the cosine.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt {

class FilmPlane {
 public:
  FilmPlane(const Camera& camera, int width, int height)
      : position_(camera.position),
        right_(camera.right),
        up_(camera.up),
        forward_(camera.forward),
        width_(width),
        height_(height),
        half_height_(std::tan(0.5 * camera.yfov)),
        half_width_(half_height_ * width / height),
        area_(4 * half_width_ * half_height_) {}

  int width() const { return width_; }
  int height() const { return height_; }
  uint64_t pixels() const { return static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_); }
  const Vec3d& position() const { return position_; }
  const Vec3d& forward() const { return forward_; }
  const Vec3d& right() const { return right_; }
  const Vec3d& up() const { return up_; }
  /// At distance 1.
  double half_width() const { return half_width_; }
  double half_height() const { return half_height_; }

  /// Unit direction through raster place (x, y).
  Vec3d direction(double x, double y) const {
    const double u = (2 * x / width_ - 1 - shift_x_) * half_width_;
    const double v = (1 - 2 * y / height_ - shift_y_) * half_height_;
    return normalize(forward_ + right_ * u + up_ * v);
  }

  /// Raster place hit by unit direction `w` (away from the camera); false if it misses the film.
  bool raster(const Vec3d& w, double& x, double& y) const {
    const double c = dot(w, forward_);
    if (!(c > 0)) return false;
    x = 0.5 * width_ * (1 + dot(w, right_) / (c * half_width_) + shift_x_);
    y = 0.5 * height_ * (1 - dot(w, up_) / (c * half_height_) - shift_y_);
    return x >= 0 && x < width_ && y >= 0 && y < height_;
  }

  /// Density of w for raster places uniform over the whole film [1/sr]: 1 / (film area * cos^3).
  double pdf_w(const Vec3d& w) const {
    const double c = dot(w, forward_);
    return 1 / (area_ * c * c * c);
  }

  /// The same film seen from the point `right`, `up` of a lens about the pinhole that shows what is
  /// `focus` in front of it sharply; all in the units of the position.
  FilmPlane through(double right, double up, double focus) const {
    FilmPlane film = *this;
    film.position_ += right_ * right + up_ * up;
    film.shift_x_ += right / (focus * half_width_);
    film.shift_y_ += up / (focus * half_height_);
    return film;
  }
  /// The same film, standing as `camera` does; its angle of view is kept.
  FilmPlane moved_to(const Camera& camera) const {
    FilmPlane film = *this;
    film.position_ = camera.position;
    film.right_ = camera.right;
    film.up_ = camera.up;
    film.forward_ = camera.forward;
    return film;
  }

 private:
  Vec3d position_, right_, up_, forward_;
  int width_, height_;
  double half_height_, half_width_, area_;
  double shift_x_ = 0, shift_y_ = 0;  // of the film to the right and up, in half sizes
};

// What blurs the picture of a camera: a thin lens, and its motion while the shutter is open.
//
// Method: distribution ray tracing (Cook et al. 1984). Each sample has a point of the lens and a
// moment, both uniform, and sees by the pinhole camera that they make [film_plane.h]. Their
// densities are the same for every technique that finds a path, so they cancel in its weights.

struct Lens {
  double radius = 0;  ///< of the aperture, a disc; 0: a pinhole
  double focus = 1;   ///< distance of the plane in focus along the view direction; may be infinite
};

class CameraBlur {
 public:
  CameraBlur() = default;
  /// Lengths are canonical. `poses`: the camera at even distances in time while the shutter is
  /// open, from its opening to its closing; fewer than two: it stands still.
  CameraBlur(const Lens& lens, std::vector<Camera> poses) : lens_(lens), poses_(std::move(poses)) {
    if (poses_.size() < 2) poses_.clear();
  }

  bool any() const { return lens_.radius > 0 || !poses_.empty(); }

  /// What a sample of `film` sees by, for numbers uniform in [0,1): two for the lens, one for time.
  FilmPlane draw(const FilmPlane& film, double u, double v, double time) const {
    FilmPlane drawn = poses_.empty() ? film : film.moved_to(pose_at(time));
    if (lens_.radius == 0) return drawn;
    const double r = lens_.radius * std::sqrt(u), angle = 2 * std::numbers::pi * v;
    return drawn.through(r * std::cos(angle), r * std::sin(angle), lens_.focus);
  }

 private:
  /// Between two poses, straight and at even speed.
  Camera pose_at(double time) const {
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

  Lens lens_;
  std::vector<Camera> poses_;
};

}  // namespace tdpt
