// Renders a range of samples of every pixel: a pure function of vista, integrator, rules and range.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "libcommon/base/progress.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

/// Settings shared by all samples of a rendering, whatever the integrator.
struct SampleRules {
  int max_depth = kMaxDepth;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
};

/// Options of a film: a layer for each technique in `layers`, a transparent background if `alpha`,
/// and two halves of the samples if `halves`.
Film::Options film_options(const TechniqueSet& layers, bool alpha, bool halves);
/// A film for pictures of it.
Film film_for(const Vista& vista, const TechniqueSet& layers, bool alpha = false,
              bool halves = false);

/// The counts of a whole rendering.
struct RenderTally {
  RayCounts rays;
  std::array<double, kTechniques> energy{};         ///< sum of luminance per technique
  std::array<double, Tally::kOctaves> by_length{};  ///< by path length, as in Tally
  struct OfPortal {
    uint64_t drawn = 0, lit = 0;
    double energy = 0;
  };
  std::vector<OfPortal> portals;  ///< as in Tally
  uint64_t not_finite = 0;
  std::vector<Tally::SamplePixel> not_finite_at;

  void add(const Tally& tally);
};

// Interface of what renders samples: the CPU or a device. All other code is the same for both.

class SampleRenderer {
 public:
  /// Renders `world_`, which must outlive it.
  explicit SampleRenderer(const Vista& vista_) : vista(vista_) {}
  virtual ~SampleRenderer() = default;
  const Vista& vista;

  virtual std::string name() const { return "cpu"; }
  virtual bool on_device() const { return false; }
  /// Does slow preparations, once, so that they do not count as rendering time.
  virtual void prepare(const Integrator&, const SampleRules&, const Film&, bool /*quiet*/) {}
  /// Renders those samples of every pixel into `film` and counts them in `tally`. `round` 0 is the
  /// picture itself; other rounds have their own random numbers. A pure function of the renderer
  /// and its arguments: film and tally do not depend on how samples are split into calls or among
  /// threads. The integrator must have been given its expected connections
  /// [expecting_connections()]. If it throws Error, film and tally hold exactly the samples that
  /// the film reports, and no part of others.
  virtual void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
                      const SampleRange& samples, Film& film, Tally& tally,
                      ProgressBar& progress) = 0;
  /// Default size of a call in samples, all pixels together: small pictures take several samples of
  /// each pixel, so that threads have enough to share.
  virtual uint64_t samples_of_pass() const { return uint64_t{1} << 16; }
};

/// Renders in doubles, in parallel.
class CpuRenderer : public SampleRenderer {
 public:
  using SampleRenderer::SampleRenderer;
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, ProgressBar& progress) override;
};

// A few pixels that represent a whole picture.

/// The k-th of a sequence of pixels {x, y} spread evenly over a picture: fractional parts of the
/// multiples of the inverse powers of the plastic number (the R2 sequence).
inline std::array<int, 2> spread_pixel(uint64_t k, int width, int height) {
  // Steps as fractions of 2^64.
  const auto spread = [k](uint64_t step, int size) {
    const uint64_t at = (k + 1) * step;
    return static_cast<int>(static_cast<double>(at >> 11) * 0x1p-53 * size);
  };
  return {spread(0xc13fa9a902a6328fULL, width), spread(0x91e10da5c79e7b1dULL, height)};
}

}  // namespace tdpt
