// Filters the noise of a picture whose samples come in two independent halves.
//
// Method: each half is filtered on its own [regression.h], guided by a first, cruder estimate of
// itself, with several bandwidths. Since the halves are independent, each tells how far the other's
// estimates are from the truth: per pixel the best bandwidth is taken, and the noisy pixel itself
// as far as the filter is certainly worse. The noise of a half falls with its samples, the filter's
// error does not: in the end the noisy pixel prevails, and the bias goes to 0. What the filter
// takes from a pixel is given back around it [outliers.h], so that the mean stays.
//
// A, B   halves, means of n_A and n_B samples per pixel; share s_A = n_A / (n_A + n_B)
// V_A    variance of A's noise: s_B (A - B)^2 in the mean
// F_A    an estimate made of the values of A, with weights from its cruder estimate. The weights of
//        that one come from B, which the formulas below neglect. F = s_A F_A + s_B F_B
// t      the truth
//   (F_A - B)^2 - V_B has the mean (F_A - t)^2, and
//   (F - t)^2 = s_A (F_A - t)^2 + s_B (F_B - t)^2 - s_A s_B (F_A - F_B)^2
//
// So the halves also tell about what error is left, of the bandwidth that the other pixels chose.
// That is too low by 1.5 on average, since it is divided by the brightness of the estimate and not
// of the truth, and knows nothing of light that neither half has met. Told is 1.5 times as much
// [doc/denoise.md].
//
// Moving pictures: values, and weights, come from the frames before and after as well. Halves of
// the same name are taken together, so that they stay independent of those of the other.
#pragma once
#include "libcommon/denoise/regression.h"

namespace tdpt::denoise {

struct Shot {
  Colour a, b;           ///< the halves; finite, not negative
  double share_a = 0.5;  ///< of the samples, inside (0,1)
  Features features;     ///< the first three: albedo, in [0,1]
};
/// Another frame of a moving picture, seen from the camera of this one [reproject.h].
struct Neighbour {
  Shot shot;      ///< without outliers
  Plane present;  ///< 0 where the frame does not show what is there, else 1
};
struct Input {
  Size size;
  Shot shot;
  std::vector<Neighbour> neighbours{};  ///< fewer than kMostSources
};

struct Result {
  Colour picture;
  size_t outliers = 0;        ///< pixels, in either half
  double outlier_energy = 0;  ///< their excess as a share of the light
  Plane error;                ///< about the relative error around each pixel
  double relmse = 0;          ///< about that of the picture; 0: not known
};

/// A function of the input, whatever the number of threads. Large pictures are filtered in blocks,
/// which do not show in the result: `block` is their largest side [pixels].
inline constexpr int kBlock = 1024;
Result denoise(Input input, int block = kBlock);

}  // namespace tdpt::denoise
