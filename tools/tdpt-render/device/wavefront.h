// Renders samples in submissions to a device (wavefront path tracing): all light walks of some
// caches, one vertex of each at a time, then their segments, then the camera walks and their
// connections.
#pragma once
#include <memory>

#include "tools/tdpt-render/device/machine.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"

namespace tdpt {

/// What a device's film keeps besides the picture.
struct FilmPlanes {
  bool layers = false, halves = false;
};

/// Offsets in the words of a film of so many pixels; `words`: the total.
struct FilmPlaces {
  uint32_t odd = 0, met = 0, tally = 0, portals = 0, words = 0;
  FilmPlaces(uint64_t pixels, const FilmPlanes& planes, size_t portals);
};

class WavefrontRenderer : public SampleRenderer {
 public:
  /// The vista must outlive it.
  WavefrontRenderer(const Vista& vista, std::unique_ptr<Machine> machine, std::string name);
  std::string name() const override { return name_; }
  bool on_device() const override { return true; }
  void prepare(const Integrator& integrator, const SampleRules& rules, const Film& film,
               bool quiet) override;
  /// Throws Error (no_device), with both numbers, if not even the paths of one cache fit.
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, ProgressBar& progress) override;

  /// What a fixed time allows: each call reads the film back from the device.
  uint64_t samples_of_pass() const override { return of_pass_; }

 private:
  /// Everything except the range of samples.
  shader::RenderParameters parameters_of(const Integrator& integrator, const SampleRules& rules,
                                         uint64_t round, const Film& film) const;
  FilmPlaces places_of(const shader::RenderParameters& parameters) const;
  bool crosses(const shader::RenderParameters& parameters) const;
  /// Until the machine's film holds all of them.
  void submit_all(shader::RenderParameters parameters, const SampleRange& samples,
                  ProgressBar& progress);
  /// False if there was no room.
  bool submit(shader::RenderParameters parameters, const std::vector<uint32_t>& cache_offsets);

  std::unique_ptr<Machine> machine_;
  const std::string name_;
  uint32_t samples_;       // in a submission: as many as fit and finish soon
  uint32_t most_samples_;  // the most that have fitted
  uint64_t of_pass_ = 0;
};

}  // namespace tdpt
