// Filters the noise of a picture whose samples come in two independent halves.
//
// Method: each half is filtered on its own [regression.h], guided by a first, cruder estimate of
// itself, with several bandwidths, and at several resolutions. Since the halves are independent,
// each tells how far the other's estimates are from the truth: from the smoothest estimate on, a
// sharper one is taken as far as it is certainly nearer to the truth, up to the noisy pixel itself.
// Coarse resolutions tell the brightness of walls, whose noise of low frequency no window of a few
// pixels averages out, fine ones the details (as in Delbracio et al. 2014). The noise of a half
// falls with its samples, the filter's error does not: in the end the noisy pixel prevails, and the
// bias goes to 0. What the filter takes from both halves is given back [planes.h], so that the
// mean stays, but for the light of single paths.
//
// A, B   halves, means of n_A and n_B samples per pixel; share s_A = n_A / (n_A + n_B)
// V_A    variance of A's noise: s_B (A - B)^2 in the mean
// F_A    an estimate made of the values of A, with weights from its cruder estimate. The weights of
//        that one come from B, which the formulas below neglect. F = s_A F_A + s_B F_B
// t      the truth
//   (F_A - B)^2 - V_B has the mean (F_A - t)^2, and
//   (F - t)^2 = s_A (F_A - t)^2 + s_B (F_B - t)^2 - s_A s_B (F_A - F_B)^2
//
// So the halves also tell what error is left, E. That is too low as far as they, who chose the
// estimates, lost their noise: v is the variance of F, V that of the noise. Told is
//   1.25 (E + v (1 - sqrt(v / V))) + half of the standard error of E over tiles of the picture
// The truth is within a factor of two of that in nine of ten pictures [doc/denoise.md]. It is not
// known of small pictures, nor where more than 1 % of the pixels have outliers: there the light is
// carried by paths that neither half has met.
//
// A guest, as Open Image Denoise, filters the same halves: the same test tells where our estimates
// are nearer to the truth than its.
//
// Moving pictures: values, and weights, come from the frames before and after as well. Halves of
// the same name are taken together, so that they stay independent of those of the other.
#pragma once
#include <optional>

#include "libcommon/denoise/regression.h"

namespace tdpt::denoise {

struct NoisyHalves {
  Colour a, b;           ///< the halves; finite, not negative
  double share_a = 0.5;  ///< of the samples, inside (0,1)
  Features features;     ///< the first three: albedo, in [0,1]
};
/// Another frame of a moving picture, seen from the camera of this one [buffers.h].
struct Neighbour {
  NoisyHalves halves;  ///< without outliers
  Plane present;       ///< 0 where the frame does not show what is there, else 1
};
/// What another filter makes of the same picture: of each half by itself, and of all samples.
struct Guest {
  Colour a, b, all;
};
struct Input {
  Size size;
  NoisyHalves halves;
  std::vector<Neighbour> neighbours{};  ///< fewer than kMostSources
  std::optional<Guest> guest{};         ///< taken where it is nearer to the truth
};

/// relMSE of the filtered picture, and an interval that holds it in nine of ten pictures.
struct ErrorLeft {
  double relmse, low, high;
};
struct Result {
  Colour picture;
  size_t outliers = 0;  ///< pixels, in either half
  double left_out = 0;  ///< share of the light that the picture lacks, which one half alone has
  std::optional<ErrorLeft> left{};
  Plane error;  ///< about the relative error around each pixel; empty where `left` is not known
};

/// A function of the input, whatever the number of threads.
Result denoise(Input input);

}  // namespace tdpt::denoise
