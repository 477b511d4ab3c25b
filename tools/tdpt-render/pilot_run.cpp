#include "tools/tdpt-render/pilot_run.h"

#include "tools/tdpt-render/work_model.h"

namespace tdpt {
namespace {

void add_weighed(std::vector<Vec3d>& to, const std::vector<Vec3d>& from, double weight) {
  to.resize(from.size());
  for (size_t i = 0; i < from.size(); ++i) to[i] += from[i] * weight;
}

class Pilot {
 public:
  Pilot(const World& world, const std::vector<Candidate>& candidates, size_t n,
        const SampleRules& rules, const TechniqueSet& layers, Progress& progress,
        const std::function<bool()>& stop)
      : world_(world),
        candidates_(candidates),
        n_(n),
        rules_(rules),
        progress_(progress),
        stop_(stop),
        pixels_(static_cast<uint64_t>(world.film.width()) *
                static_cast<uint64_t>(world.film.height())),
        film_(film_for(world, layers)),
        errors_(world.film.width(), world.film.height(), n),
        work_(world),
        weights_(n),
        out_(n),
        rays_(n),
        records_(n) {
    weights_[0] = 1;
    for (size_t i = 0; i < n; ++i) records_[i].integrator = candidates[i].label;
  }

  PilotRun fly(uint64_t rounds) {
    for (uint64_t round = 1; round <= rounds && !run_.cut_short; ++round) {
      for (size_t i = 0; i < n_ && !run_.cut_short; ++i)
        if (!out_[i]) run_.cut_short = !round_of(i, round);
      if (!run_.cut_short) conclude(round);
    }
    // Of a round that was not finished nothing is known but its samples.
    if (concluded_) run_.records = std::move(records_);
    return std::move(run_);
  }

 private:
  // One round of one candidate; false when it had to end early.
  bool round_of(size_t i, uint64_t round) {
    std::array<std::vector<Vec3d>, 2> pictures;
    for (uint64_t half = 0; half < 2; ++half) {
      film_.clear();
      Tally tally(film_.unit());
      render_samples(world_, candidates_[i].integrator, rules_, round, {half, 1}, film_, tally,
                     progress_);
      pictures[half] = film_.sums();
      keep(i, pictures[half], tally);
      if (stop_()) return false;
    }
    errors_.add_round(i, pictures[0], pictures[1]);
    const bool directed = candidates_[i].integrator.mixture.guiding != Guiding{};
    records_[i].work = work_.per_sample(rays_[i], records_[i].spp * pixels_, directed);
    return true;
  }

  void keep(size_t i, const std::vector<Vec3d>& picture, const Tally& tally) {
    const double weight = weights_[i];
    if (weight > 0) {
      add_weighed(run_.sums, picture, weight);
      for (size_t layer = 0; layer < Film::kMostLayers; ++layer)
        if (film_.has_layer(layer))
          add_weighed(run_.layers[layer], film_.layer_sums(layer), weight);
    }
    run_.weight += weight;
    run_.tally.add(tally, weight);
    ++run_.samples;
    records_[i].share += weight;
    ++records_[i].spp;
    rays_[i].merge(tally.rays);
  }

  void conclude(uint64_t round) {
    const std::vector<double> relmse = errors_.relmse();
    for (size_t i = 0; i < n_; ++i) records_[i].relmse = relmse[i];
    run_.chosen = best_of(records_);
    concluded_ = true;
    if (2 * static_cast<double>(round * pixels_) < kLeastSamples) return;
    out_ = hopeless(records_, out_);
    weights_ = pilot_weights(relmse, out_);
  }

  const World& world_;
  const std::vector<Candidate>& candidates_;
  const size_t n_;
  const SampleRules& rules_;
  Progress& progress_;
  const std::function<bool()>& stop_;
  const uint64_t pixels_;
  Film film_;
  PilotErrors errors_;
  WorkModel work_;
  std::vector<double> weights_;
  std::vector<bool> out_;
  std::vector<RayCounts> rays_;
  std::vector<PilotRecord> records_;
  bool concluded_ = false;  // a round
  PilotRun run_;
};

}  // namespace

PilotRun fly_pilot(const World& world, const std::vector<Candidate>& candidates,
                   const PilotPlan& plan, const SampleRules& rules, const TechniqueSet& layers,
                   Progress& progress, const std::function<bool()>& stop) {
  return Pilot(world, candidates, plan.candidates, rules, layers, progress, stop).fly(plan.rounds);
}

}  // namespace tdpt
