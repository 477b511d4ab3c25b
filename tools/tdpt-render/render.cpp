#include "tools/tdpt-render/render.h"

#include <chrono>

#include "libcommon/base/signals.h"
#include "libcommon/base/threads.h"
#include "tools/tdpt-render/pilot_run.h"

namespace tdpt {

Vec3d mean_of(const Picture& picture) {
  Vec3d sum;
  for (const Rgb& p : picture.pixels) sum += Vec3d(p);
  return sum / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

double nonzero_of(const Picture& picture) {
  size_t n = 0;
  for (const Rgb& p : picture.pixels) n += p != Rgb{};
  return static_cast<double>(n) / static_cast<double>(std::max<size_t>(picture.pixels.size(), 1));
}

uint64_t next_frame(uint64_t spp) {
  return spp + std::max<uint64_t>(1, spp < 256 ? 1 : spp / 16);
}

namespace {

// Wall-clock and CPU time of rendering; what is done aside does not count.
class Clock {
 public:
  double seconds() const { return since_start() - aside_; }
  double cpu() const { return cpu_seconds() - cpu_start_ - cpu_aside_; }
  template <class Work>
  void aside(const Work& work) {
    const double seconds = since_start(), cpu = cpu_seconds();
    work();
    aside_ += since_start() - seconds;
    cpu_aside_ += cpu_seconds() - cpu;
  }

 private:
  using Steady = std::chrono::steady_clock;
  double since_start() const {
    return std::chrono::duration<double>(Steady::now() - start_).count();
  }
  const Steady::time_point start_ = Steady::now();
  const double cpu_start_ = cpu_seconds();
  double aside_ = 0, cpu_aside_ = 0;
};

TechniqueSet techniques_of(const std::vector<Candidate>& candidates) {
  TechniqueSet all;
  for (const Candidate& c : candidates) all = all | c.integrator.mixture.techniques;
  return all;
}

// Plans, renders what was planned, and puts the picture together: the film's samples and, where a
// pilot flew, what it has kept.
class Rendering {
 public:
  Rendering(const World& world, const std::vector<Candidate>& candidates,
            const RenderSettings& settings)
      : world_(world),
        candidates_(candidates),
        settings_(settings),
        techniques_(techniques_of(candidates)),
        rules_{settings.max_depth, settings.beta, settings.seed},
        layers_(settings.layers ? techniques_ : TechniqueSet()),
        pixels_(static_cast<uint64_t>(world.film.width()) *
                static_cast<uint64_t>(world.film.height())),
        film_(film_for(world, layers_)),
        tally_(film_.unit()),
        progress_("rendering", "samples", settings.spp * pixels_, settings.quiet) {}

  /// Decides who renders, and what a pilot's part of the picture will be.
  void plan();
  /// Renders until the plan's samples are there, or the time is up.
  void samples();
  RenderResult finish();

 private:
  /// Of the film's own samples and of the pilot's, in the picture.
  struct Shares {
    double own = 0, pilot = 0;
  };
  Shares shares() const;
  uint64_t rendered() const { return film_.samples() + pilot_.samples; }
  bool out_of_time() const { return settings_.seconds > 0 && clock_.seconds() > settings_.seconds; }
  void render(const SampleRange& range) {
    render_samples(world_, plan_.integrator, rules_, 0, range, film_, tally_, progress_);
  }
  bool wants_pilot(PilotPlan& pilot);
  uint64_t next_pass(uint64_t most, uint64_t planned_before, double began) const;
  Picture mixed(const std::vector<Vec3d>& own, const std::vector<Vec3d>& pilot) const;
  void record_frame();
  void last_frame();

  const World& world_;
  const std::vector<Candidate>& candidates_;
  const RenderSettings& settings_;
  const TechniqueSet techniques_;  // of all candidates
  const SampleRules rules_;
  const TechniqueSet layers_;
  const uint64_t pixels_;
  Clock clock_;
  Film film_;
  Tally tally_;  // of the film
  Progress progress_;
  Plan plan_;
  PilotRun pilot_;
  RenderTally discarded_;  // counts of samples that are not in the picture
  uint64_t discarded_spp_ = 0;
  bool cut_short_ = false;  // the pilot, or what comes after it
  std::vector<FrameRecord> frames_;
};

// By the clock, a first sample of the first candidate tells how many fit into the time.
bool Rendering::wants_pilot(PilotPlan& pilot) {
  if (candidates_.size() < 2) return false;
  const bool by_clock = settings_.seconds > 0;
  auto spp = static_cast<double>(settings_.spp);
  if (by_clock) {
    render({0, 1});
    const double in_time = settings_.seconds / clock_.seconds();
    spp = settings_.spp > 0 ? std::min(spp, in_time) : in_time;
    if (stop_requested()) return false;
  }
  pilot = settings_.pilot.value_or(plan_pilot(spp, pixels_, candidates_.size(), !by_clock));
  return pilot.rounds > 0;
}

void Rendering::plan() {
  plan_ = {candidates_[0].integrator, candidates_[0].label, settings_.spp, {}, 0};
  PilotPlan pilot;
  if (!wants_pilot(pilot)) return;
  pilot_ = fly_pilot(world_, candidates_, pilot, rules_, layers_, progress_,
                     [&] { return stop_requested() || out_of_time(); });
  cut_short_ = pilot_.cut_short;
  plan_.integrator = candidates_[pilot_.chosen].integrator;
  plan_.label = candidates_[pilot_.chosen].label;
  plan_.pilot_share = pilot.kept;
  if (pilot_.chosen == 0 || film_.samples() == 0) return;
  // The sample that told the time was the first candidate's.
  discarded_spp_ = film_.samples();
  discarded_.add(tally_, 0);
  film_.clear();
  tally_ = Tally(film_.unit());
}

Rendering::Shares Rendering::shares() const {
  const auto n = static_cast<double>(film_.samples());
  if (pilot_.weight == 0) return {n > 0 ? 1 / n : 0, 0};
  if (n == 0) return {0, 1 / pilot_.weight};
  // Ended before its time, the pilot is more of the picture than was planned.
  const double a = cut_short_ ? std::max(plan_.pilot_share, pilot_.weight / (pilot_.weight + n))
                              : plan_.pilot_share;
  return {(1 - a) / n, a / pilot_.weight};
}

Picture Rendering::mixed(const std::vector<Vec3d>& own, const std::vector<Vec3d>& pilot) const {
  const Shares s = shares();
  Picture picture{film_.width(), film_.height(), {}};
  picture.pixels.reserve(own.size());
  for (size_t i = 0; i < own.size(); ++i) {
    const Vec3d of_film = own[i] * s.own;
    picture.pixels.emplace_back(Vec3f(pilot.empty() ? of_film : of_film + pilot[i] * s.pilot));
  }
  return picture;
}

void Rendering::record_frame() {
  const double seconds = clock_.seconds(), cpu = clock_.cpu();
  clock_.aside([&] {
    const Picture picture = mixed(film_.sums(), pilot_.sums);
    frames_.push_back(
        {rendered() + discarded_spp_, nonzero_of(picture), mean_of(picture), seconds, cpu});
  });
}

// How many samples come next, `most` at the most; 0: the picture is done, or the time is up.
uint64_t Rendering::next_pass(uint64_t most, uint64_t planned_before, double began) const {
  const uint64_t done = rendered() + discarded_spp_;
  if (settings_.spp > 0 && done >= settings_.spp) return 0;
  uint64_t n = settings_.spp == 0 ? most : std::min(most, settings_.spp - done);
  if (settings_.frames)
    n = std::min(n, next_frame(frames_.empty() ? planned_before : frames_.back().spp) - done);
  if (done == 0 || settings_.seconds == 0) return n;  // there must be a picture
  // Samples take about as long as the ones before: stop where the limit is nearest.
  const uint64_t since = done - planned_before;
  const double per_sample = since > 0 ? (clock_.seconds() - began) / static_cast<double>(since)
                                      : clock_.seconds() / static_cast<double>(done);
  const double in_time = (settings_.seconds - clock_.seconds()) / per_sample;
  if (since == 0)  // after a pilot alone little is known of the time
    n = static_cast<uint64_t>(std::clamp(in_time, 1.0, static_cast<double>(n)));
  return in_time < 0.5 * static_cast<double>(n) ? 0 : n;
}

void Rendering::samples() {
  // Small pictures take several samples a pass, so that threads have something to share.
  const uint64_t most = std::max<uint64_t>(1, (uint64_t{1} << 16) / pixels_);
  const uint64_t before = rendered() + discarded_spp_;
  const double began = clock_.seconds();
  uint64_t last = before;  // frame
  while (true) {
    const uint64_t n = next_pass(most, before, began);
    if (n == 0) break;
    // A signal that comes when all is there cuts nothing short.
    cut_short_ |= stop_requested() && rendered() > 0;
    if (cut_short_) break;
    render({film_.samples(), n});
    if (settings_.frames && rendered() + discarded_spp_ == next_frame(last)) {
      record_frame();
      last = frames_.back().spp;
    }
  }
  if (settings_.frames) last_frame();
}

// The last frame is the picture, with the shares that it has now.
void Rendering::last_frame() {
  const bool stale = cut_short_ && pilot_.weight > 0;
  const bool there = !frames_.empty() && frames_.back().spp == rendered() + discarded_spp_;
  if (stale && there) frames_.pop_back();
  if (stale || !there) record_frame();
}

RenderResult Rendering::finish() {
  RenderResult result;
  result.seconds = clock_.seconds();
  result.cpu_seconds = clock_.cpu();
  result.interrupted = cut_short_ && stop_requested();
  result.spp = rendered() + discarded_spp_;
  result.plan = plan_;
  result.chosen = pilot_.chosen;
  if (candidates_.size() > 1) result.chosen_label = plan_.label;
  result.frames = std::move(frames_);
  const Shares s = shares();
  result.tally.add(tally_, 1);
  result.tally.add(discarded_, 0);
  if (pilot_.weight > 0) {
    result.tally.add(pilot_.tally, s.own > 0 ? s.pilot / s.own : 1);
    result.pilot = std::move(pilot_.records);
    for (PilotRecord& record : result.pilot) record.share *= s.pilot;
    if (!result.pilot.empty())
      result.pilot[result.chosen].share += s.own * static_cast<double>(film_.samples());
    // What the pilot drew through portals tells nothing of a picture that it is a small part of.
    if (!plan_.integrator.mixture.has(Technique::portal)) result.tally.portals.clear();
  }
  result.picture = mixed(film_.sums(), pilot_.sums);
  for (size_t i = 0; i < kTechniques; ++i)
    if (layers_.has(static_cast<Technique>(i)))
      result.layers[kTechniqueNames[i]] = mixed(film_.layer_sums(i), pilot_.layers[i]);
  return result;
}

}  // namespace

RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const std::vector<PortalWay>& ways) {
  Rendering rendering(world, candidates, settings);
  rendering.plan();
  rendering.samples();
  RenderResult result = rendering.finish();
  result.plan.ways = ways;
  return result;
}

RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings) {
  return render(world, std::vector<Candidate>{{integrator, integrator.name}}, settings);
}

}  // namespace tdpt
