// What a filter needs of a picture file: its halves and features, as planes of checked numbers; and
// another frame of a moving picture, moved to where this one shows the same.
//
// Method of that: reverse reprojection. The place x that a pixel sees, by camera and depth, is
// looked up in the other picture, between four pixels; those show it whose depth agrees. Where one
// of them is far brighter, as at the edge of a lamp, their mixture is taken for nothing that is
// seen from here.
//
//   x = eye + w z / (w . forward)     w through the pixel's centre, z its depth
//
// What has moved, or is lit otherwise, shows a surface at the same depth that looks different; the
// weights of the regression tell.
#pragma once
#include "libcommon/denoise/denoise.h"
#include "libcommon/film/film.h"
#include "libcommon/formats/picture.h"
#include "libcommon/scene/film_plane.h"

namespace tdpt::denoise {

/// Layer with the picture as it was rendered, beside the filtered one.
inline constexpr const char* kNoisyLayer = "noisy";
inline constexpr std::array kFeatureChannels{"albedo.R", "albedo.G", "albedo.B", "normal.X",
                                             "normal.Y", "normal.Z", "depth.Z"};
static_assert(kFeatureChannels.size() == kFeatures);

/// Where a picture was seen from.
struct View {
  FilmPlane film;  ///< metres
  Plane depth;     ///< along the camera's axis [m]; kNothing or more where nothing is seen
  Size size() const { return {film.width(), film.height()}; }
};
inline constexpr float kNothing = 1e9f;

/// All members throw InputError, with the file's name, if something is missing or no number.
class Buffers {
 public:
  /// Keeps references to both.
  Buffers(const ExrFile& file, const std::string& name) : file_(file), name_(name) {}

  Size size() const { return {file_.picture.width, file_.picture.height}; }
  /// As it was rendered, whether or not it is filtered now.
  const Picture& noisy() const;
  /// The same; also throws if there is a negative number.
  Colour light() const;
  /// Checks that the picture is a weighted mean of its halves. `any`: whether there are features;
  /// those that are missing are 0.
  NoisyHalves halves(bool& any) const;
  /// Empty if it is missing.
  Plane channel(const std::string& channel) const;
  View view() const;

 private:
  Colour colour(const Picture& picture, const std::string& layer) const;
  Colour half(const char* layer) const;
  Features features(bool& any) const;
  double share_of(const Colour& picture, const Colour& a, const Colour& b) const;
  void check(const Plane& plane, const std::string& channel) const;
  [[noreturn]] void refuse(const std::string& channel, size_t pixel,
                           const std::string& words) const;

  const ExrFile& file_;
  const std::string& name_;
};

/// `there`, from its view, as seen from that of `here`. Where it does not show what is there, the
/// neighbour has the numbers of `here`.
Neighbour reproject(const NoisyHalves& there, const View& from, const NoisyHalves& here,
                    const View& to);

}  // namespace tdpt::denoise
