// For tests: the error that a pilot should report, from many pictures.
#pragma once
#include <vector>

#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt {

/// relMSE of one sample, normalised per pixel as in exrdiff, from each pixel's variance over
/// pictures of 16 samples.
inline double error_of_pictures(const Vista& vista, const Integrator& integrator,
                                int max_depth = kMaxDepth) {
  constexpr int kPictures = 24;
  Job settings;
  settings.limits.spp = 16;
  settings.max_depth = max_depth;
  const size_t pixels = vista.view.film.pixels();
  std::vector<double> sum(pixels), squares(pixels);
  for (int i = 0; i < kPictures; ++i) {
    settings.seed = 100 + static_cast<uint64_t>(i);
    const Picture p = render(vista, integrator, settings).picture;
    for (size_t k = 0; k < pixels; ++k) {
      const double l = luminance(p.pixels[k]);
      sum[k] += l, squares[k] += l * l;
    }
  }
  double mean = 0, error = 0;
  for (const double s : sum) mean += s / kPictures / static_cast<double>(pixels);
  for (size_t k = 0; k < pixels; ++k) {
    const double m = sum[k] / kPictures;
    const double variance = (squares[k] / kPictures - m * m) * kPictures / (kPictures - 1);
    error += variance * static_cast<double>(settings.limits.spp) / (m * m + 0.01 * mean * mean);
  }
  return error / static_cast<double>(pixels);
}

}  // namespace tdpt
