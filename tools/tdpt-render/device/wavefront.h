// Renders a submission step by step: a device, or the scalar build of its kernels on the CPU. Both
// follow the same schedule of steps [wavefront.h].
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libcommon/base/progress.h"
#include "shaders/shared/path/render_layout.h"
#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

/// The kernels, or what the scalar build runs in their place [steps.def].
enum class Step : uint8_t {
#define STEP(name, call) name,
#include "shaders/shared/path/steps.def"
  kSteps
};
inline constexpr std::array<const char*, static_cast<size_t>(Step::kSteps)> kStepNames{
#define STEP(name, call) #name,
#include "shaders/shared/path/steps.def"
};

struct Capacity {
  uint32_t vertices = 0;  ///< slots
  uint32_t samples = 0;   ///< in a submission; at least kMostOfCache
  constexpr uint32_t connections() const { return 4 * samples; }  ///< at a time
  constexpr uint64_t estimates() const { return 16 * uint64_t{vertices}; }
  /// The most flags that any step needs.
  constexpr uint32_t flags() const { return std::max(vertices, connections()); }
};

/// Samples in a cache, at most.
constexpr uint32_t kMostOfCache = 256;

class Machine {
 public:
  virtual ~Machine() = default;
  virtual Capacity room() const = 0;
  /// For all steps that follow. `cache_offsets`: by sample of cache 0, the position of its pixel
  /// within its stretch.
  virtual void set(const shader::RenderParameters& parameters,
                   const std::vector<uint32_t>& cache_offsets) = 0;
  /// Steps run one after the other.
  virtual void run(Step step, const shader::StepParameters& parameters) = 0;
  /// Compacts the `count` items that a step flagged, in order, to their slots from `first` on, and
  /// ranks each by how many come before it. Returns their number.
  virtual uint32_t pick(uint32_t count, uint32_t first = 0) = 0;
  /// Allocates places for the light vertices that connections can use, walk by walk.
  virtual void place_ends(uint32_t walks) = 0;
  /// Returns all words of the film and its counters, and clears them.
  virtual std::vector<uint32_t> take_film() = 0;
};

// Renders samples in submissions to a device (wavefront path tracing): all light walks of some
// caches, one vertex of each at a time, then their segments, then the camera walks and their
// connections.

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
