// Estimates the noise of a picture while it renders, for display only: the stopping point does not
// depend on it. It uses blocks of the picture's own samples [error_estimate.h] at some of its
// pixels, so that it costs next to nothing.
#pragma once
#include <optional>
#include <string>

#include "libcommon/film/film.h"
#include "tools/tdpt-render/plan/error_estimate.h"

namespace tdpt {

struct Noise {
  double relmse = 0;         ///< of the picture, estimated
  double low = 0, high = 0;  ///< its interval, about 95 %
  bool tells = false;        ///< else it may be many times too large
};

/// While it renders: "relMSE about 0.012 [0.011, 0.014]", or that more samples are needed to tell.
std::string words_of(const Noise& noise);
/// At the end: how noisy the picture is, and what a clean one takes.
/// `seconds`: that it took on this machine.
std::string noise_sentence(const Noise& noise, double seconds);

class NoiseWatch {
 public:
  static constexpr size_t kMostPixels = 1 << 14;

  /// Watches what is added to the film from now on. `samples`: that are to come, for a renderer
  /// that would rather not be stopped: it is then looked at when a fourth to an eighth of them are
  /// there, and no sooner. 0: at once.
  explicit NoiseWatch(const Film& film, uint64_t samples = 0);
  /// Number of samples of the film that is to be looked at.
  uint64_t next() const { return from_ + blocks_.next(); }
  void look(const Film& film) { blocks_.add(film.sums(step_)); }
  /// Nothing before four blocks have been seen, and of a picture without light.
  std::optional<Noise> noise(const Film& film) const;

 private:
  size_t step_;    // from one pixel that is watched to the next
  uint64_t from_;  // samples that were there
  PictureBlocks blocks_;
};

}  // namespace tdpt
