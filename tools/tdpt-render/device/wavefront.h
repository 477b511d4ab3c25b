// Renders samples in submissions of a device: all light walks of some caches, a vertex of each at a
// time, then their segments, then all that the camera's walks do with them.
#pragma once
#include <memory>

#include "tools/tdpt-render/device/machine.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"

namespace tdpt {

class WavefrontRenderer : public SampleRenderer {
 public:
  /// The world must outlive it, with the portals that it has now.
  WavefrontRenderer(const World& world, std::unique_ptr<Machine> machine, std::string name);
  std::string name() const override { return name_; }
  bool on_device() const override { return true; }
  void prepare(const Integrator& integrator, const SampleRules& rules, const Film& film,
               bool quiet) override;
  /// Throws Error (no_device), with both numbers, where not even one cache's paths have room.
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, Progress& progress) override;

  /// What a second brings: each call brings the film back from the device.
  uint64_t samples_of_pass() const override { return of_pass_; }

 private:
  /// All but which samples.
  shader::RenderParameters parameters_of(const Integrator& integrator, const SampleRules& rules,
                                         uint64_t round, const Film& film) const;
  bool crosses(const shader::RenderParameters& parameters) const;
  /// Until the machine's film holds them all.
  void submit_all(shader::RenderParameters parameters, const SampleRange& samples,
                  Progress& progress);
  /// False when there was no room.
  bool submit(shader::RenderParameters parameters, const std::vector<uint32_t>& cache_offsets);

  std::unique_ptr<Machine> machine_;
  const std::string name_;
  uint32_t samples_;       // of a submission: as many as have had room, and are soon done
  uint32_t most_samples_;  // that have had room
  uint64_t of_pass_ = 0;
};

/// Where things lie in the words of a film of so many pixels; `words`: of all.
struct FilmPlaces {
  uint32_t met = 0, tally = 0, portals = 0, words = 0;
  FilmPlaces(uint64_t pixels, bool layers, size_t portals);
};

}  // namespace tdpt
