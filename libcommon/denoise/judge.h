// Judges estimates of a picture by its independent halves: which of two is nearer to the truth, and
// what error is left. Formulas: denoise.h. All is light, divided by the albedo.
#pragma once
#include <cstdint>

#include "libcommon/denoise/denoise.h"

namespace tdpt::denoise {

struct Halves {
  Colour a, b;
};

double mean_of(const Plane& plane);
double mean_of(const Colour& colour);
/// share_a A + (1 - share_a) B.
Colour mean(const Colour& a, const Colour& b, float share_a);

/// Division by the albedo leaves the light, which is smoother. Multiplication restores it.
enum class Albedo : uint8_t { divide, multiply };
void by_albedo(Colour& colour, Albedo how, const Features& features);

/// Tells by the halves which of two estimates is nearer to the truth.
class Judge {
 public:
  /// `light`: mean radiance. Keeps a reference to the halves.
  Judge(Size size, const NoisyHalves& halves, double light);

  /// The share w of the way from one estimate, f, to another, f + d, that has the least error
  /// around each pixel, itself left out: its own noise would favour the estimate that happens to be
  /// near it. The error is quadratic in w:
  ///   w = (x - certain^2 v / x) / y   if x > certain sqrt(v), else 0;  at most 1
  /// x the products of d with what f lacks, y the squares of d, v the variance of x. So what
  /// differs from f by chance is not taken [as James and Stein's estimator].
  Plane share(const Halves& from, const Halves& to, double certain) const;

  /// Unbiased, of one channel of a pixel.
  float squared_error(const Halves& f, size_t c, size_t i) const;

 private:
  const Size size_;
  const float share_a_;
  const NoisyHalves& noisy_;
  Colour per_;   // factors of squared errors
  Plane noise_;  // relative variance of the noise
};

/// Sets `left` and `error` of a result, estimated by `f`, as far as they are known.
void estimate_error(const Input& input, const Halves& f, double light, Result& result);

}  // namespace tdpt::denoise
