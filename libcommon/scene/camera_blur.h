// What blurs the picture of a camera: a thin lens, and its motion while the shutter is open.
//
// Method: distribution ray tracing (Cook et al. 1984). Each sample has a point of the lens and a
// moment, both uniform, and sees by the pinhole camera that they make [film_plane.h]. Their
// densities are the same for every technique that finds a path, so they cancel in its weights.
#pragma once
#include <vector>

#include "libcommon/scene/film_plane.h"

namespace tdpt {

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
  FilmPlane draw(const FilmPlane& film, double u, double v, double time) const;

 private:
  /// Between two poses, straight and at even speed.
  Camera pose_at(double time) const;

  Lens lens_;
  std::vector<Camera> poses_;
};

}  // namespace tdpt
