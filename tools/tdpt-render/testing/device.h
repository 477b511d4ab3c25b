// For tests: the result of rendering on a machine, to the last word of the film.
#pragma once
#include <cstring>
#include <functional>
#include <ostream>

#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/scalar_build.h"

namespace tdpt {

/// The complete result of some samples.
struct Outcome {
  std::vector<unsigned char> film;  ///< its numbers as they are in memory
  std::vector<Units> counts;        ///< of the tally
  std::vector<Tally::SamplePixel> not_finite_at;
  double brightness = 0;  ///< mean luminance over pixels and samples

  friend bool operator==(const Outcome& a, const Outcome& b) {
    return a.film == b.film && a.counts == b.counts && a.not_finite_at == b.not_finite_at;
  }
};

inline void PrintTo(const Outcome& o, std::ostream* out) {
  *out << "a film of mean luminance " << o.brightness;
  for (const Units units : o.counts) *out << " " << static_cast<uint64_t>(units);
}

inline Outcome outcome_of(Film& film, const Tally& tally) {
  Outcome o;
  const size_t pixels = static_cast<size_t>(film.width()) * static_cast<size_t>(film.height());
  for (const Film::Numbers& n : film.numbers())
    o.film.insert(o.film.end(), n.first, n.first + pixels * n.each * n.bytes);
  o.counts = {tally.rays.closest, tally.rays.shadow, tally.rays.portal, tally.rays.connect,
              tally.not_finite};
  for (const UnitSum& sum : tally.energy) o.counts.push_back(sum.units());
  for (const UnitSum& sum : tally.by_length) o.counts.push_back(sum.units());
  for (const Tally::OfPortal& portal : tally.portals)
    o.counts.insert(o.counts.end(), {portal.drawn, portal.lit, portal.energy.units()});
  o.not_finite_at = tally.not_finite_at;
  o.brightness = luminance(Rgb(mean_of(film.picture())));
  return o;
}

struct Samples {
  SampleRange range{0, 2};
  SampleRules rules{8};
  bool alpha = false, layers = false, halves = false;
};

inline Outcome rendered_by(SampleRenderer& renderer, const Vista& vista,
                           const Integrator& integrator, const Samples& samples) {
  const int depth = samples.rules.max_depth;
  Integrator expecting = integrator;
  expecting.mixture = expecting_connections(vista, integrator.mixture, depth);
  Film film = film_for(vista, samples.layers ? integrator.mixture.techniques : TechniqueSet(),
                       samples.alpha, samples.halves);
  Tally tally(film.unit());
  ProgressBar progress("rendering", "samples", 0, true);
  renderer.render(expecting, samples.rules, 0, samples.range, film, tally, progress);
  return outcome_of(film, tally);
}

/// Faults planted in a machine for a twin.
struct Faults {
  std::function<void(RenderTables&)> tables{};
  std::function<void(shader::RenderParameters&)> parameters{};
  Step skipped = Step::kSteps;
};

/// Wraps another machine, with less room.
class Borrowed : public Machine {
 public:
  Borrowed(Machine& machine, const Capacity& room, const Faults& faults = {})
      : machine_(machine), room_(room), faults_(faults) {}

  Capacity room() const override { return room_; }
  void set(const shader::RenderParameters& parameters,
           const std::vector<uint32_t>& cache_offsets) override {
    shader::RenderParameters p = parameters;
    if (faults_.parameters) faults_.parameters(p);
    machine_.set(p, cache_offsets);
  }
  void run(Step step, const shader::StepParameters& p) override {
    if (step != faults_.skipped) machine_.run(step, p);
  }
  uint32_t pick(uint32_t count, uint32_t first) override { return machine_.pick(count, first); }
  void place_ends(uint32_t walks) override { machine_.place_ends(walks); }
  std::vector<uint32_t> take_film() override { return machine_.take_film(); }

 private:
  Machine& machine_;
  const Capacity room_;
  const Faults faults_;
};

/// Number of words of films of the vista's size that keep everything.
inline uint32_t film_words(const Vista& vista) {
  return FilmPlaces(vista.view.film.pixels(), {true, true}, vista.openings.portals.portals()).words;
}

constexpr Capacity kEnough{1u << 17, 1u << 12};

/// Renders by the scalar build of the device's kernels.
class ScalarRenderer : public SampleRenderer {
 public:
  explicit ScalarRenderer(const Vista& vista_, const Capacity& room = kEnough,
                          const Faults& faults = {})
      : SampleRenderer(vista_), tables_(vista_) {
    if (faults.tables) faults.tables(tables_);
    machine_ = make_scalar_machine(tables_, room, film_words(vista));
    renderer_ = std::make_unique<WavefrontRenderer>(
        vista, std::make_unique<Borrowed>(*machine_, room, faults), "scalar build");
  }
  bool on_device() const override { return true; }
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally,
              ProgressBar& progress) override {
    renderer_->render(integrator, rules, round, samples, film, tally, progress);
  }

 private:
  RenderTables tables_;
  std::unique_ptr<Machine> machine_;
  std::unique_ptr<WavefrontRenderer> renderer_;
};

}  // namespace tdpt
