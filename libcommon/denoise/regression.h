// Estimates each pixel of a noisy picture from its neighbours.
//
// Method: weighted linear regression on features (Bitterli et al. 2016, Nonlinearly Weighted
// First-order Regression for Denoising Monte Carlo Renderings) with the weights of nonlocal means
// (Buades et al. 2005; Rousselle et al. 2012). For pixel p and its neighbours q in a window:
//
//   minimise over a, b:  sum over q of w(p,q) (c(q) - a - b . (f(q) - f(p)))^2 + ridge |b|^2
//
// The estimate is a: what the neighbours that look alike would have with p's features. Neighbours
// may also be those in other frames of a moving picture.
//
// c      colour        f  features: albedo, normal, depth
// g, v   guide picture that tells which pixels look alike, and the variance of its noise
// t      tolerance: differences of about its root count as alike
// d^2    = mean over the patches around p and q and over channels of
//          ((g(p) - g(q))^2 - v(p) - min(v(p), v(q))) / (t(p) + t(q)), at least 0
// w      about exp(-d^2 / k^2), for several bandwidths k, times a Gaussian of the distance in
// pixels;
//        w(p,p) is the largest of the others
#pragma once
#include <span>

#include "libcommon/denoise/planes.h"

namespace tdpt::denoise {

inline constexpr int kReach = 6;  ///< the window is 2 kReach + 1 pixels wide
inline constexpr size_t kFeatures = 7;
/// In [-1,1].
using Features = std::array<Plane, kFeatures>;

/// A picture, aligned with that of which pixels are estimated.
struct Source {
  const Colour& data;
  const Features& features;
  const Colour &guide, &variance, &tolerance;
  const Plane& present;  ///< 0 where it does not show what is there; empty: all
};
inline constexpr size_t kMostSources = 3;

struct Patches {
  int radius;             ///< [pixels], at most kMostPatch
  float least_tolerance;  ///< above 0
};
inline constexpr int kMostPatch = 3;

/// Estimates of the first source by the neighbours in all, at most kMostSources; one for each
/// bandwidth, none below 0. A function of its arguments, whatever the number of threads. All planes
/// have that size and are finite.
std::vector<Colour> regressions(Size size, std::span<const Source> sources, Patches patches,
                                std::span<const float> bandwidths);

}  // namespace tdpt::denoise
