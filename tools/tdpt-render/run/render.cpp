#include "tools/tdpt-render/run/render.h"

#include <bit>
#include <chrono>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/signals.h"
#include "libcommon/base/threads.h"
#include "tools/tdpt-render/plan/longest_path.h"
#include "tools/tdpt-render/plan/pilot.h"

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

uint64_t spp_foreseen(const RenderSettings& settings) {
  constexpr uint64_t kOfTarget = 64;  // before anything is known
  if (settings.target_error == 0) return settings.spp;
  return settings.spp > 0 ? std::min(settings.spp, kOfTarget) : kOfTarget;
}

uint64_t next_frame(uint64_t spp) {
  return spp + std::max<uint64_t>(1, spp < 256 ? 1 : spp / 16);
}

Film::Options film_options(const World& world, const std::vector<Candidate>& candidates,
                           const RenderSettings& settings) {
  TechniqueSet all;
  for (const Candidate& c : candidates) all = all | c.integrator.mixture.techniques;
  const bool varies = longest_path(world, settings.max_depth, settings.alpha) > 0;
  return film_options(settings.layers ? all : TechniqueSet(), settings.alpha,
                      settings.variance && varies ? 1 : 0);
}

namespace {

constexpr uint64_t kMostSamples = uint64_t{1} << 32;  // of a pixel, as --spp

// Wall-clock and CPU time of rendering; what is done aside does not count.
class Clock {
 public:
  /// `seconds`, `cpu`: spent before.
  Clock(double seconds, double cpu) : aside_(-seconds), cpu_aside_(-cpu) {}
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
  double aside_, cpu_aside_;
};

Standing beginning(const World& world, const std::vector<Candidate>& candidates,
                   const RenderSettings& settings, const Course& course) {
  Standing standing(Film(world.film.width(), world.film.height(), world.lights.power(),
                         film_options(world, candidates, settings)),
                    settings.limits());
  if (course.plan) standing.goal = course.plan->spp;
  if (course.part.count == 0) return standing;
  standing.first = course.part.first;
  standing.goal = course.part.count;
  standing.whole = course.whole;
  return standing;
}

// Plans, renders what was planned, and puts the picture together.
class Rendering {
 public:
  Rendering(const World& world, const std::vector<Candidate>& candidates,
            const RenderSettings& settings, Course course)
      : world_(world),
        candidates_(expecting_joins(world, candidates, settings.max_depth)),
        settings_(settings),
        cpu_(world),
        renderer_(settings.device ? *settings.device : cpu_),
        course_(std::move(course)),
        longest_(longest_path(world, settings.max_depth, settings.alpha)),
        rules_{std::max(longest_, 1), settings.beta, settings.seed},
        pixels_(static_cast<uint64_t>(world.film.width()) *
                static_cast<uint64_t>(world.film.height())),
        goes_on_(course_.standing.has_value()),
        standing_(goes_on_ ? std::move(*course_.standing)
                           : beginning(world, candidates, settings, course_)),
        clock_(standing_.seconds, standing_.cpu_seconds),
        watch_(film_),
        framed_(film_.samples()) {}

  /// Decides who renders. `ways`: decided before.
  void plan(const std::vector<PortalWay>& ways);
  /// Finds out how many samples the error takes that is asked for, if one is, and the time, if the
  /// settings want to know.
  void aim();
  /// Whether a signal came before all of it was decided.
  void note_haste() { result_.hasty = !course_.plan && stop_requested(); }
  /// What is beyond the limit of depth, if there is one.
  void look_beyond();
  /// Renders until the plan's samples are there, or the time is up.
  void samples();
  RenderResult finish();

 private:
  void look_around(Scout& scout);
  double spp_ahead(const Scout& scout) const;
  uint64_t next_pass() const;
  void obey_plan();
  void make_ready();
  void aim_at_error();
  uint64_t samples_in_time();
  Film aside() const { return film_for(world_, TechniqueSet()); }
  void receive_visitors();
  void render_pass(uint64_t samples, Progress& progress);
  void record_frame();
  void render_goal();
  void judge();
  bool retry_is_due();
  std::string error_so_far() const;

  const World& world_;
  const std::vector<Candidate> candidates_;
  const RenderSettings& settings_;
  CpuRenderer cpu_;
  SampleRenderer& renderer_;
  Course course_;
  const int longest_;  // path that can bring light; 0: none can
  const SampleRules rules_;
  const uint64_t pixels_;
  const bool goes_on_;
  Standing standing_;
  Film& film_ = standing_.film;
  uint64_t& goal_ = standing_.goal;
  std::optional<TargetOutcome>& target_ = standing_.target;
  Pilot& pilot_ = standing_.pilot;
  PictureBlocks& blocks_ = standing_.blocks;
  Clock clock_;
  NoiseWatch watch_;
  bool ready_ = false;
  uint64_t framed_;          // samples when the last frame was recorded
  std::vector<double> due_;  // when each visitor came last, or later [s]
  RenderResult result_;
};

// In rounds, each as large as all before, so that a short time is not overrun by much.
void Rendering::look_around(Scout& scout) {
  const auto spp = static_cast<double>(spp_foreseen(settings_));
  const bool by_clock = settings_.seconds > 0;
  const double time =
      0.5 * scouts_share(32) * settings_.seconds;  // the last round is the other half
  if (spp > 0 && !can_spare(spp, pixels_, scout)) return;
  for (uint64_t n = kFewestGroups; n > 0 && !stop_requested();) {
    scout.draw(n, film_);
    if (by_clock && clock_.seconds() > time) break;
    const uint64_t enough = spp > 0 ? groups_for(spp, pixels_, scout) : kMostGroups;
    n = std::min(scout.groups(), enough - std::min(enough, scout.groups()));
  }
  film_.clear();
}

// Samples of each pixel that there will be, about; by the clock those of a core's worth of the
// time.
double Rendering::spp_ahead(const Scout& scout) const {
  if (const uint64_t spp = spp_foreseen(settings_)) return static_cast<double>(spp);
  return settings_.seconds * 1e9 * scout.samples_of_group() /
         (scout.work_of_group() * static_cast<double>(pixels_));
}

void Rendering::plan(const std::vector<PortalWay>& ways) {
  result_.plan = {candidates_[0].integrator, candidates_[0].label, settings_.spp, ways,
                  world_.lights.shares()};
  if (longest_ < settings_.max_depth || world_.lights.empty()) result_.longest = longest_;
  if (course_.plan) return obey_plan();
  if (candidates_.size() < 2) return;
  result_.chosen_label = candidates_[0].label;
  if (result_.longest) return;
  const double cpu = clock_.cpu();
  Scout scout(world_, candidates_, rules_, settings_.device ? kDeviceWork : kCpuWork);
  look_around(scout);
  result_.scout_cpu_seconds = clock_.cpu() - cpu;
  if (scout.groups() > 0) {
    result_.prospects = scout.prospects();
    result_.chosen = best_of(result_.prospects, scout.groups(), spp_ahead(scout));
    result_.scouted = scout.groups() * scout.samples_of_group();
  }
  result_.plan.integrator = candidates_[result_.chosen].integrator;
  result_.plan.label = result_.chosen_label = candidates_[result_.chosen].label;
}

void Rendering::obey_plan() {
  result_.plan = *course_.plan;
  if (candidates_.size() < 2) return;
  result_.chosen_label = result_.plan.label;
  for (size_t i = 0; i < candidates_.size(); ++i)
    if (candidates_[i].label == result_.plan.label) result_.chosen = i;
}

// Before the first samples, of whatever kind; what the renderer takes for it does not count.
void Rendering::make_ready() {
  if (ready_) return;
  ready_ = true;
  clock_.aside([&] { renderer_.prepare(result_.plan.integrator, rules_, film_, settings_.quiet); });
}

void Rendering::aim() {
  if (goes_on_ || course_.plan) return;
  if (settings_.target_error > 0) aim_at_error();
  if (!settings_.fixed || settings_.seconds == 0 || (target_ && target_->dark)) return;
  const uint64_t most = samples_in_time();
  goal_ = goal_ > 0 ? std::min(goal_, most) : most;
  result_.plan.spp = goal_;
}

// As fast as the last of some that are thrown away, twice as many each time; of the form m 2^j,
// m < 16, as samples_needed() has it.
uint64_t Rendering::samples_in_time() {
  constexpr double kShare = 0.02;
  if (longest_ == 0) return 1;
  make_ready();
  Progress progress("measuring the time", "samples", 0, settings_.quiet);
  Film film = aside();
  Tally tally(film.unit());
  double each = 0;
  for (uint64_t n = 1, done = 0; !stop_requested(); done += n, n *= 2) {
    const double before = clock_.seconds();
    renderer_.render(result_.plan.integrator, rules_, kTimingRound.first, {done, n}, film, tally,
                     progress);
    const double took = clock_.seconds() - before;
    each = took / static_cast<double>(n);
    if (took > kShare * settings_.seconds) break;
  }
  if (!(each > 0)) return 1;  // a signal came first
  const double left = std::max(settings_.seconds - clock_.seconds(), 0.0);
  auto samples = static_cast<uint64_t>(std::clamp(left / each, 1.0, 0x1p32));
  while (static_cast<int>(std::bit_width(samples)) > std::countr_zero(samples) + 4)
    samples &= samples - 1;
  return samples;
}

void Rendering::aim_at_error() {
  TargetOutcome& target = target_.emplace();
  target.error = settings_.target_error;
  target.dark = longest_ == 0 || world_.lights.empty();
  target.may_retry = !settings_.retry;
  if (target.dark) {
    if (settings_.spp == 0) goal_ = settings_.alpha ? 16 : 1;
    target.fixed = goal_;
    return;
  }
  make_ready();
  const double cpu = clock_.cpu();
  const auto give_up = [&] {
    const bool late = settings_.seconds > 0 && clock_.seconds() > 0.5 * settings_.seconds;
    return late || stop_requested();
  };
  {
    Film film = aside();
    Progress progress("measuring the error", "samples", 0, settings_.quiet);
    const uint64_t most = settings_.spp > 0 ? settings_.spp : kMostSamples;
    pilot_ = run_pilot(renderer_, result_.plan.integrator, rules_, target.error, most, give_up,
                       film, progress);
  }
  target.pilot_samples = Pilot::kParts * pilot_.part_samples();
  target.pilot_cpu_seconds = clock_.cpu() - cpu;
  target.fixed = pilot_.needed;
  // Where the pilot met no light the picture gets as many samples: they may.
  goal_ = pilot_.needed > 0 ? pilot_.needed : target.pilot_samples;
  if (settings_.spp > 0) goal_ = goal_ > 0 ? std::min(goal_, settings_.spp) : settings_.spp;
  if (goal_ == 0 && settings_.seconds == 0) goal_ = kMostSamples;  // a signal came: it ends it
  result_.plan.spp = goal_;
}

// Blocks of so many samples tell more than a pilot does, whatever they tell.
constexpr uint64_t kTelling = 8;

// What the picture's own blocks tell of its error; what the pilot's parts do where those tell too
// little, or there are fewer than three.
void Rendering::judge() {
  TargetOutcome& target = *target_;
  const auto done = static_cast<double>(film_.samples());
  using Stop = TargetOutcome::Stop;
  if (result_.interrupted)
    target.stop = Stop::signal;
  else if (goal_ == 0 || film_.samples() < goal_)
    target.stop = Stop::time;
  else if (goal_ == settings_.spp && target.fixed != goal_)
    target.stop = Stop::spp;
  else
    target.stop = target.fixed > 0 ? Stop::fixed : Stop::unlit;
  const auto& blocks = blocks_.blocks();
  ErrorEstimate told = blocks.size() > 2 ? estimate_error(blocks) : ErrorEstimate{};
  uint64_t of = blocks_.size();
  if (!tells(told) && of < kTelling && !pilot_.rounds.empty()) {
    const Pilot::Round& round = pilot_.about(film_.samples());
    if (round.estimate.lit && (tells(round.estimate) || round.samples > of || !told.lit))
      told = round.estimate, of = round.samples;
  }
  target.relmse.reset();
  if (!told.lit) return;
  target.relmse = told.relmse * static_cast<double>(of) / done;
  target.low = *target.relmse / interval_factor(told);
  target.high = *target.relmse * interval_factor(told);
}

// Then there is a new goal. The samples that are there stay.
bool Rendering::retry_is_due() {
  if (!settings_.retry || !target_ || target_->retried) return false;
  TargetOutcome& target = *target_;
  const ErrorEstimate told =
      blocks_.blocks().size() > 2 ? estimate_error(blocks_.blocks()) : ErrorEstimate{};
  const bool known = tells(told) || (told.lit && blocks_.size() >= kTelling);
  if (target.stop != TargetOutcome::Stop::fixed || target.reached() || !known) return false;
  const uint64_t needed =
      samples_needed(told, blocks_.blocks().size(), blocks_.size(), target.error);
  const uint64_t goal = settings_.spp > 0 ? std::min(needed, settings_.spp) : needed;
  if (goal <= film_.samples()) {
    if (needed > goal) target.stop = TargetOutcome::Stop::spp;
    return false;
  }
  target.fixed = needed;
  goal_ = goal;
  return target.retried = true;
}

// "relMSE about 0.02", as the pilot foresees it, or the picture tells.
std::string Rendering::error_so_far() const {
  if (!target_) {
    const std::optional<Noise> noise = watch_.noise(film_);
    return noise && noise->tells ? fmt::format("relMSE about {}", number_words(noise->relmse, 2))
                                 : "";
  }
  if (pilot_.rounds.empty() || film_.samples() == 0) return "";
  const Pilot::Round& round = pilot_.about(film_.samples());
  if (!(round.estimate.relmse > 0)) return "";
  const double of = static_cast<double>(round.samples) / static_cast<double>(film_.samples());
  return fmt::format("relMSE about {}", number_words(round.estimate.relmse * of, 2));
}

void Rendering::look_beyond() {
  // Of the parts of a picture the first tells it for all.
  if (settings_.max_depth >= kMaxDepth || result_.longest || standing_.first > 0) return;
  // A hundredth of the picture's samples, but of few of them up to a tenth; by the clock, enough.
  const double all = static_cast<double>(goal_) * static_cast<double>(pixels_), enough = 2048;
  const double samples = all > 0 ? std::max(0.01 * all, std::min(0.1 * all, enough)) : enough;
  Film film = aside();
  result_.beyond = light_beyond(world_, result_.plan.integrator, rules_, samples, film);
}

void Rendering::record_frame() {
  const double seconds = clock_.seconds(), cpu = clock_.cpu();
  clock_.aside([&] {
    const Picture picture = film_.picture();
    result_.frames.push_back(
        {film_.samples(), nonzero_of(picture), mean_of(picture), seconds, cpu});
    framed_ = film_.samples();
  });
}

// How many samples come next; 0: the picture is done, or the time is up.
uint64_t Rendering::next_pass() const {
  const uint64_t done = film_.samples();
  if (goal_ > 0 && done >= goal_) return 0;
  const uint64_t most = std::max<uint64_t>(renderer_.samples_of_pass() / pixels_, 1);
  uint64_t n = goal_ == 0 ? most : std::min(most, goal_ - done);
  if (film_.options().error_block > 0) n = 1;  // of a block
  n = std::min(n, (target_ ? blocks_.next() : watch_.next()) - done);
  if (settings_.frames) n = std::min(n, next_frame(framed_) - done);
  if (longest_ == 0) return 0;
  if (settings_.seconds == 0) return n;
  if (done == 0) return 1;  // there must be a picture
  // Samples take about as long as the ones before: stop where the limit is nearest.
  const double per_sample = (clock_.seconds() - standing_.began) / static_cast<double>(done);
  const double in_time = (settings_.seconds - clock_.seconds()) / per_sample;
  return in_time < 0.5 ? 0 : std::min(n, static_cast<uint64_t>(std::max(in_time, 1.0)));
}

// Not more than a tenth of the time goes into one, however large the picture.
void Rendering::receive_visitors() {
  if (result_.hasty) return;
  due_.resize(course_.visitors.size(), standing_.began);
  for (size_t i = 0; i < due_.size(); ++i) {
    const Course::Visitor& visitor = course_.visitors[i];
    const double now = clock_.seconds();
    if (now < due_[i] + visitor.every) continue;
    standing_.seconds = now;
    standing_.cpu_seconds = clock_.cpu();
    const auto before = std::chrono::steady_clock::now();
    clock_.aside([&] { visitor.visit(standing_, result_.plan); });
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    due_[i] = now + std::max(0.0, 10 * took.count() - visitor.every);
  }
}

void Rendering::render_pass(uint64_t samples, Progress& progress) {
  try {
    renderer_.render(result_.plan.integrator, rules_, 0, {standing_.next(), samples}, film_,
                     standing_.tally, progress);
  } catch (const Error&) {
    standing_.seconds = clock_.seconds();
    standing_.cpu_seconds = clock_.cpu();
    if (course_.rescue && film_.samples() > 0 && !result_.hasty)
      course_.rescue(standing_, result_.plan);
    throw;
  }
}

void Rendering::render_goal() {
  if (next_pass() > 0) make_ready();
  Progress progress("rendering", "samples", (goal_ - std::min(goal_, film_.samples())) * pixels_,
                    settings_.quiet);
  if (goal_ == 0) progress.ends_after(settings_.seconds - clock_.seconds());
  if (settings_.device && goal_ > film_.samples())
    watch_ = NoiseWatch(film_, goal_ - film_.samples());
  if (const uint64_t all = std::max<uint64_t>(goal_, 1); longest_ == 0 && film_.samples() < all)
    film_.complete({standing_.next(), all - film_.samples()});
  while (const uint64_t n = next_pass()) {
    // A signal that comes when all is there cuts nothing short, and there must be a picture.
    result_.interrupted = stop_requested() && film_.samples() > 0;
    if (result_.interrupted) break;
    progress.tell(error_so_far());
    render_pass(n, progress);
    if (target_ && film_.samples() == blocks_.next()) blocks_.add(film_.sums());
    if (!target_ && film_.samples() == watch_.next()) watch_.look(film_);
    if (settings_.frames && film_.samples() == next_frame(framed_)) record_frame();
    receive_visitors();
  }
}

void Rendering::samples() {
  if (!goes_on_) standing_.began = clock_.seconds();
  render_goal();
  if (target_) judge();
  if (retry_is_due()) {
    render_goal();
    judge();
  }
  const std::vector<FrameRecord>& frames = result_.frames;
  if (settings_.frames && (frames.empty() || frames.back().spp != film_.samples())) record_frame();
}

RenderResult Rendering::finish() {
  result_.seconds = clock_.seconds();
  result_.cpu_seconds = clock_.cpu();
  result_.spp = film_.samples();
  result_.tally.add(standing_.tally);
  // What has ended by the clock has ended.
  if (goal_ == 0 && !result_.interrupted) goal_ = film_.samples();
  result_.target = target_;
  if (!target_) result_.noise = watch_.noise(film_);
  result_.picture = film_.picture();
  for (size_t i = 0; i < kTechniques; ++i)
    if (film_.has_layer(i)) result_.layers[kTechniqueNames[i]] = film_.layer(i);
  standing_.seconds = result_.seconds;
  standing_.cpu_seconds = result_.cpu_seconds;
  result_.standing = std::make_shared<Standing>(std::move(standing_));
  return std::move(result_);
}

}  // namespace

RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const std::vector<PortalWay>& ways,
                    Course course) {
  Rendering rendering(world, candidates, settings, std::move(course));
  rendering.plan(ways);
  rendering.aim();
  rendering.note_haste();
  rendering.look_beyond();
  rendering.samples();
  return rendering.finish();
}

RenderResult decide(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const std::vector<PortalWay>& ways) {
  Rendering rendering(world, candidates, settings, {});
  rendering.plan(ways);
  rendering.aim();
  return rendering.finish();
}

RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings) {
  return render(world, std::vector<Candidate>{{integrator, integrator.name}}, settings);
}

}  // namespace tdpt
