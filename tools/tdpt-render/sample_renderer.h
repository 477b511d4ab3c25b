// Who renders samples: the CPU, or a device. All else about a picture is the same, whoever does.
#pragma once
#include "tools/tdpt-render/passes.h"

namespace tdpt {

class SampleRenderer {
 public:
  virtual ~SampleRenderer() = default;
  /// As render_samples(): a pure function of the renderer and its arguments, however samples are
  /// split into calls. The integrator expects its joins [expecting_joins()].
  virtual void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
                      const SampleRange& samples, Film& film, Tally& tally, Progress& progress) = 0;
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
