// Moves another frame of a moving picture to where this one shows the same.
//
// Method: reverse reprojection. The place x that a pixel sees, by camera and depth, is looked up in
// the other picture, between four pixels; those show it whose depth agrees. Where one of them is
// far brighter, as at the edge of a lamp, their mixture is taken for nothing that is seen from
// here.
//
//   x = eye + w z / (w . forward)     w through the pixel's centre, z its depth
//
// What has moved, or is lit otherwise, shows a surface at the same depth that looks different; the
// weights of the regression tell.
#pragma once
#include "libcommon/denoise/denoise.h"
#include "libcommon/scene/film_plane.h"

namespace tdpt::denoise {

struct View {
  FilmPlane film;  ///< metres
  Plane depth;     ///< along the camera's axis [m]; kNothing or more where nothing is seen
};
inline constexpr float kNothing = 1e9f;

/// `there`, from its view, as seen from that of `here`. Where it does not show what is there, the
/// neighbour has the numbers of `here`.
Neighbour reproject(const Shot& there, const View& from, const Shot& here, const View& to);

}  // namespace tdpt::denoise
