#include "tools/tdpt-render/render.h"

#include <chrono>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/progress.h"
#include "libcommon/base/signals.h"
#include "libcommon/base/threads.h"
#include "tools/tdpt-render/work_model.h"

namespace tdpt {
Vec3d RenderResult::mean() const {
  Vec3d sum;
  for (const Rgb& p : picture.pixels) sum += Vec3d(p);
  return sum / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

double RenderResult::nonzero() const {
  size_t n = 0;
  for (const Rgb& p : picture.pixels) n += p != Rgb{};
  return static_cast<double>(n) / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

uint64_t next_frame(uint64_t spp) {
  return spp + std::max<uint64_t>(1, spp < 256 ? 1 : spp / 16);
}

namespace {

void add(RayCounts& sum, const RayCounts& rays) {
  sum.closest += rays.closest;
  sum.shadow += rays.shadow;
  sum.portal += rays.portal;
}

// What counts towards the picture, and not what was done for it.
void scale_energy(Tally& tally, double factor) {
  for (double& e : tally.energy) e *= factor;
  for (Tally::OfPortal& portal : tally.portals) portal.energy *= factor;
}

class Loop {
 public:
  Loop(const World& world, const RenderSettings& settings, TechniqueSet techniques)
      : world_(world),
        settings_(settings),
        width_(world.film.width()),
        height_(world.film.height()),
        techniques_(techniques),
        pixels_(static_cast<uint64_t>(width_) * static_cast<uint64_t>(height_)),
        film_(make_film()),
        progress_("rendering", "samples", settings.spp * pixels_, settings.quiet),
        rows_(static_cast<size_t>(height_)) {}

  /// Chooses one of the candidates to render the rest.
  const Integrator& pilot(const std::vector<Candidate>& candidates);
  void samples(const Integrator& integrator);
  RenderResult finish(const Integrator& integrator);

 private:
  using Clock = std::chrono::steady_clock;
  struct Probing;

  size_t choose(const std::vector<Candidate>& candidates);

  Film make_film() const {
    return Film(width_, height_, world_.lights.power(),
                settings_.layers ? techniques_ : TechniqueSet());
  }
  double since_start() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }
  double elapsed() const { return since_start() - aside_; }
  bool out_of_time() const { return settings_.seconds > 0 && elapsed() > settings_.seconds; }

  /// Samples first .. first + n - 1 of every pixel; `round` 0: of the rendering itself, else the
  /// pilot's round, whose random numbers are its own.
  void pass(const Integrator& integrator, uint64_t round, uint64_t first, uint64_t n, Film& film,
            std::vector<Tally>& rows);
  /// One round of one candidate, weighed by probing.weights[i]; false when it had to end early.
  bool round_of(Probing& probing, size_t i, uint64_t round);
  Film::Shares shares() const;
  void record_frame();

  const World& world_;
  const RenderSettings& settings_;
  const int width_, height_;
  const TechniqueSet techniques_;  // of all candidates
  const uint64_t pixels_;
  Film film_;
  RenderResult result_;
  Progress progress_;
  std::vector<Tally> rows_;
  uint64_t spp_ = 0;  // of film_'s own samples

  // Of the pilot: the part of the picture that is planned for it, the weights that its samples have
  // together, 1 for each, and what it counted, energies weighed.
  double kept_ = 0, weight_ = 0;
  Tally pilot_tally_;
  bool cut_short_ = false;  // the pilot, or what comes after it

  const Clock::time_point start_ = Clock::now();
  const double cpu_start_ = cpu_seconds();
  // Time spent on measuring frames is no time of rendering.
  double aside_ = 0, cpu_aside_ = 0;
};

void Loop::pass(const Integrator& integrator, uint64_t round, uint64_t first, uint64_t n,
                Film& film, std::vector<Tally>& rows) {
  // No integrator has a stream as large.
  constexpr uint64_t kStreams = 1024;
  const SampleSettings sample_settings{integrator.mixture, settings_.max_depth, settings_.beta,
                                       settings_.seed, integrator.stream + kStreams * round};
  tbb::parallel_for(0, height_, [&](int y) {
    PathSampler sampler(world_, sample_settings, film, rows[static_cast<size_t>(y)]);
    for (int x = 0; x < width_; ++x) {
      for (uint64_t s = first; s < first + n; ++s) {
        sampler.begin(x, y, s);
        sampler.run();
        sampler.end();
      }
    }
    progress_.advance(static_cast<uint64_t>(width_) * n);
  });
  result_.spp += n;
}

Film::Shares Loop::shares() const {
  if (weight_ == 0) return Film::mean_of(spp_);
  if (spp_ == 0) return {0, 1 / weight_};
  const auto n = static_cast<double>(spp_);
  // Ended before its time, the pilot is more of the picture than was planned.
  const double a = cut_short_ ? std::max(kept_, weight_ / (weight_ + n)) : kept_;
  return {(1 - a) / n, a / weight_};
}

void Loop::record_frame() {
  const double seconds = elapsed(), cpu = cpu_seconds();
  const Film::Measure measure = film_.measure(shares());
  result_.frames.push_back(
      {result_.spp, measure.nonzero, measure.mean, seconds, cpu - cpu_start_ - cpu_aside_});
  aside_ = since_start() - seconds;
  cpu_aside_ += cpu_seconds() - cpu;
}

struct Loop::Probing {
  const std::vector<Candidate>& candidates;
  Film film;
  PilotErrors errors;
  WorkModel model;
  std::vector<double> weights;
  std::vector<bool> out;
  std::vector<RayCounts> rays;
  std::vector<PilotRecord> records;
};

bool Loop::round_of(Probing& probing, size_t i, uint64_t round) {
  std::array<std::vector<Vec3d>, 2> pictures;
  PilotRecord& record = probing.records[i];
  for (uint64_t half = 0; half < 2; ++half) {
    std::vector<Tally> rows(static_cast<size_t>(height_));
    probing.film.clear();
    pass(probing.candidates[i].integrator, round, half, 1, probing.film, rows);
    const double weight = probing.weights[i];
    Tally tally;
    for (const Tally& row : rows) tally.merge(row);
    if (weight > 0) film_.add_other(probing.film, weight);
    weight_ += weight;
    record.share += weight;
    ++record.spp;
    add(probing.rays[i], tally.rays);
    scale_energy(tally, weight);
    pilot_tally_.merge(tally);
    pictures[half] = probing.film.sums();
    if (stop_requested() || out_of_time()) return false;
  }
  probing.errors.add_round(i, pictures[0], pictures[1]);
  const bool directed = probing.candidates[i].integrator.mixture.guiding != Guiding{};
  record.work = probing.model.per_sample(probing.rays[i], record.spp * pixels_, directed);
  return true;
}

const Integrator& Loop::pilot(const std::vector<Candidate>& candidates) {
  result_.chosen = choose(candidates);
  if (candidates.size() > 1) result_.chosen_label = candidates[result_.chosen].label;
  return candidates[result_.chosen].integrator;
}

size_t Loop::choose(const std::vector<Candidate>& candidates) {
  if (candidates.size() < 2) return 0;
  const bool by_clock = settings_.seconds > 0;
  auto spp = static_cast<double>(settings_.spp);
  if (by_clock) {
    pass(candidates[0].integrator, 0, 0, 1, film_, rows_);
    spp_ = 1;
    const double in_time = settings_.seconds / elapsed();
    spp = settings_.spp > 0 ? std::min(spp, in_time) : in_time;
    if (stop_requested()) return 0;
  }
  const PilotPlan plan =
      settings_.pilot.value_or(plan_pilot(spp, pixels_, candidates.size(), !by_clock));
  if (plan.rounds == 0) return 0;
  kept_ = plan.kept;

  const size_t n = plan.candidates;
  Probing probing{candidates,
                  make_film(),
                  PilotErrors(width_, height_, n),
                  WorkModel(world_),
                  std::vector<double>(n),
                  std::vector<bool>(n),
                  std::vector<RayCounts>(n),
                  std::vector<PilotRecord>(n)};
  probing.weights[0] = 1;
  for (size_t i = 0; i < n; ++i) probing.records[i].integrator = candidates[i].label;
  size_t best = 0;
  for (uint64_t round = 1; round <= plan.rounds && !cut_short_; ++round) {
    for (size_t i = 0; i < n && !cut_short_; ++i)
      if (!probing.out[i]) cut_short_ = !round_of(probing, i, round);
    if (cut_short_) break;
    const std::vector<double> relmse = probing.errors.relmse();
    for (size_t i = 0; i < n; ++i) probing.records[i].relmse = relmse[i];
    best = best_of(probing.records);
    if (2 * static_cast<double>(round * pixels_) >= kLeastSamples) {
      probing.out = hopeless(probing.records, probing.out);
      probing.weights = pilot_weights(relmse, probing.out);
    }
    if (round == 1) result_.pilot = probing.records;
  }
  // Of a round that was not finished nothing is known but its samples.
  if (!result_.pilot.empty()) result_.pilot = std::move(probing.records);
  if (best != 0 && spp_ > 0) {  // the sample that told the time was the first candidate's
    film_.clear();
    spp_ = 0;
    for (Tally& row : rows_) {
      scale_energy(row, 0);
      pilot_tally_.merge(row);
      row = {};
    }
  }
  return best;
}

void Loop::samples(const Integrator& integrator) {
  // Small pictures take several samples a pass, so that threads have something to share.
  const uint64_t most = std::max<uint64_t>(1, (uint64_t{1} << 16) / pixels_);
  const uint64_t before = spp_;
  const double began = elapsed();
  uint64_t last_frame = result_.spp;
  const auto wanted = [&] { return settings_.spp == 0 || result_.spp < settings_.spp; };
  // Samples take about as long as the ones before: stop where the limit is nearest.
  const auto in_time = [&] {
    const double per_sample = spp_ > before
                                  ? (elapsed() - began) / static_cast<double>(spp_ - before)
                                  : elapsed() / static_cast<double>(result_.spp);
    return (settings_.seconds - elapsed()) / per_sample;
  };
  while (wanted()) {
    uint64_t n = settings_.spp == 0 ? most : std::min(most, settings_.spp - result_.spp);
    if (settings_.frames) n = std::min(n, next_frame(last_frame) - result_.spp);
    if (result_.spp > 0) {  // there is a picture
      cut_short_ |= stop_requested();
      if (cut_short_) break;
      if (settings_.seconds > 0) {
        // After a pilot alone little is known of the time.
        if (spp_ == before)
          n = static_cast<uint64_t>(std::clamp(in_time(), 1.0, static_cast<double>(n)));
        if (in_time() < 0.5 * static_cast<double>(n)) break;
      }
    }
    pass(integrator, 0, spp_, n, film_, rows_);
    spp_ += n;
    if (settings_.frames && result_.spp == next_frame(last_frame)) {
      record_frame();
      last_frame = result_.spp;
    }
  }
  result_.interrupted = cut_short_ && stop_requested();
  if (!settings_.frames) return;
  // The last frame is the picture, with the shares that it has now.
  const bool stale = cut_short_ && weight_ > 0;
  if (stale && last_frame == result_.spp && !result_.frames.empty()) result_.frames.pop_back();
  if (stale || last_frame < result_.spp) record_frame();
}

RenderResult Loop::finish(const Integrator& integrator) {
  result_.seconds = elapsed();
  result_.cpu_seconds = cpu_seconds() - cpu_start_ - cpu_aside_;
  for (const Tally& row : rows_) result_.tally.merge(row);
  const Film::Shares s = shares();
  if (weight_ > 0) {
    if (s.samples > 0) scale_energy(pilot_tally_, s.others / s.samples);
    result_.tally.merge(pilot_tally_);
    for (PilotRecord& record : result_.pilot) record.share *= s.others;
    if (!result_.pilot.empty())
      result_.pilot[result_.chosen].share += s.samples * static_cast<double>(spp_);
    // What the pilot drew through portals tells nothing of a picture that it is a small part of.
    if (!integrator.mixture.has(Technique::portal)) result_.tally.portals.clear();
  }
  result_.picture = film_.resolve(s);
  for (size_t i = 0; settings_.layers && i < kTechniques; ++i)
    if (const auto t = static_cast<Technique>(i); techniques_.has(t))
      result_.layers[kTechniqueNames[i]] = film_.resolve_layer(t, s);
  return std::move(result_);
}

}  // namespace

RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings) {
  TechniqueSet techniques;
  for (const Candidate& candidate : candidates)
    techniques = techniques | candidate.integrator.mixture.techniques;
  Loop loop(world, settings, techniques);
  const Integrator& integrator = loop.pilot(candidates);
  loop.samples(integrator);
  return loop.finish(integrator);
}

RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings) {
  return render(world, std::vector<Candidate>{{integrator, integrator.name}}, settings);
}

}  // namespace tdpt
