// How noisy a picture is, estimated from the picture alone: its relMSE as exrdiff reports it
// against a converged one, with an interval that holds in nine of ten pictures; nothing where that
// is not known. For display, and to judge a target: no sample depends on it.
//
// It uses blocks of the picture's own samples at some of its pixels, so that it costs next to
// nothing.
//
// x_k   block k of K of a pixel's component; m the mean of all, M that of all pixels
// n     mean of the 24 pixels around it
// r     the brightness: relMSE = mean of E[(m - r)^2] / (r^2 + 0.01 M^2)
//
//   V    = variance of m, from that of the blocks
//   r    = n + (m - n) max(0, 1 - V / (m - n)^2), the estimator of James and Stein: a pixel is as
//          bright as those around it unless it differs by more than its noise. So one bright sample
//          does not pass for brightness, nor a pixel without one for black
//   high = mean of V / (r^2 + 0.01 M^2). Samples are stratified, across blocks too, so the picture
//          is better than its blocks show
//   low  = the same of (m - n)^2 24/25 in the place of V in those runs of pixels where its sum is
//          less: what differs no more from its surroundings cannot be noisier
//   The estimate is the geometric mean of the two. The interval reaches from one to the other and
//   on each side as far as chance goes: the errors of the pixels, of which few may hold most, are
//   known no better than the error itself.
//
// Paths that no sample met are in neither.
#pragma once
#include <optional>
#include <string>

#include "libcommon/film/film.h"
#include "tools/tdpt-render/plan/error_estimate.h"

namespace tdpt {

struct Noise {
  double relmse = 0;         ///< of the picture
  double low = 0, high = 0;  ///< its interval, 90 %
};

/// From one pixel that is watched to the next: at most 2^14 are, in every column.
size_t watched_step(const Film& film);
/// `blocks`: of the film's samples from the first on, at the watched pixels.
std::optional<Noise> noise_of(const Film& film, const PictureBlocks& blocks);

/// "relMSE 0.012, 0.011 to 0.014".
std::string words_of(const Noise& noise);
/// At the end: how noisy the picture is, and what a clean one takes.
/// `seconds`: that it took on this machine.
std::string noise_sentence(const std::optional<Noise>& noise, double seconds);

}  // namespace tdpt
