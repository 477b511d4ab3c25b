// Who renders samples: the CPU, or a device. All else about a picture is the same, whoever does.
#pragma once
#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

class SampleRenderer {
 public:
  virtual ~SampleRenderer() = default;
  /// Makes ready what takes its time, once: no time of a rendering has it in it.
  virtual void prepare(const Integrator&, const SampleRules&, const Film&, bool /*quiet*/) {}
  /// As render_samples(): a pure function of the renderer and its arguments, however samples are
  /// split into calls. The integrator expects its joins [expecting_joins()]. Where it throws Error
  /// the film and the tally have the samples that the film says, and no part of others.
  virtual void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
                      const SampleRange& samples, Film& film, Tally& tally, Progress& progress) = 0;
  /// Samples, of all pixels together, that suit a call where nothing wants fewer: small pictures
  /// take several of each, so that threads have something to share.
  virtual uint64_t samples_of_pass() const { return uint64_t{1} << 16; }
};

/// In doubles, in parallel.
class CpuRenderer : public SampleRenderer {
 public:
  explicit CpuRenderer(const World& world) : world_(world) {}
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, Progress& progress) override {
    render_samples(world_, integrator, rules, round, samples, film, tally, progress);
  }

 private:
  const World& world_;
};

}  // namespace tdpt
