// Who renders samples: the CPU, or a device. All else about a picture is the same, whoever does.
#pragma once
#include <string>

#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

class SampleRenderer {
 public:
  /// Renders this world, which must outlive it.
  explicit SampleRenderer(const World& world_) : world(world_) {}
  virtual ~SampleRenderer() = default;
  const World& world;

  virtual std::string name() const { return "cpu"; }
  virtual bool on_device() const { return false; }
  /// Makes ready what takes its time, once: no time of a rendering has it in it.
  virtual void prepare(const Integrator&, const SampleRules&, const Film&, bool /*quiet*/) {}
  /// As render_samples(): a pure function of the renderer and its arguments, however samples are
  /// split into calls. The integrator expects its connections [expecting_connections()]. Where it
  /// throws Error the film and the tally have the samples that the film says, and no part of
  /// others.
  virtual void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
                      const SampleRange& samples, Film& film, Tally& tally, Progress& progress) = 0;
  /// Samples, of all pixels together, that suit a call where nothing wants fewer: small pictures
  /// take several of each, so that threads have something to share.
  virtual uint64_t samples_of_pass() const { return uint64_t{1} << 16; }
};

/// In doubles, in parallel.
class CpuRenderer : public SampleRenderer {
 public:
  using SampleRenderer::SampleRenderer;
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, Progress& progress) override {
    render_samples(world, integrator, rules, round, samples, film, tally, progress);
  }
};

}  // namespace tdpt
