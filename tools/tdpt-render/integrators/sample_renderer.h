// Interface of what renders samples: the CPU or a device. All other code is the same for both.
#pragma once
#include <string>

#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

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
  /// Same as render_samples(): a pure function of the renderer and its arguments, however samples
  /// are split into calls. The integrator must have been given its expected connections
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
              const SampleRange& samples, Film& film, Tally& tally,
              ProgressBar& progress) override {
    render_samples(vista, integrator, rules, round, samples, film, tally, progress);
  }
};

}  // namespace tdpt
