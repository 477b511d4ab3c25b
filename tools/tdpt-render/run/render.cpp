#include "tools/tdpt-render/run/render.h"

#include <bit>
#include <chrono>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/signals.h"

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

Film::Options film_options(const std::vector<Candidate>& candidates,
                           const RenderSettings& settings) {
  TechniqueSet all;
  for (const Candidate& c : candidates) all = all | c.integrator.mixture.techniques;
  return film_options(settings.layers ? all : TechniqueSet(), settings.alpha, settings.halves);
}

namespace {

// Renders by a decision, pass by pass.
class Rendering {
 public:
  Rendering(Session& session, const RenderSchedule& schedule, RenderResult& result)
      : session_(session),
        settings_(session.settings),
        schedule_(schedule),
        result_(result),
        render_state_(*result.render_state),
        film_(render_state_.film),
        framed_(render_state_.frames.empty() ? film_.samples() : render_state_.frames.back().spp) {
    begin_blocks();
  }

  /// Until all samples are rendered or the time is up.
  void run();

 private:
  void begin_blocks();
  void look();
  uint64_t next_pass() const;
  void receive_visitors();
  void render_pass(uint64_t samples, Progress& progress);
  void record_frame();
  void render_goal();
  TargetProgress stand() const;
  std::string error_so_far() const;

  Session& session_;
  const RenderSettings& settings_;
  const RenderSchedule& schedule_;
  RenderResult& result_;
  RenderState& render_state_;
  Film& film_;
  uint64_t framed_;          // samples when the last frame was recorded
  std::string noise_words_;  // as of the last block
  std::vector<double> due_;  // when each visitor's period last began [s]
};

// A device would rather not be stopped: its first block is a fourth of the picture. Samples without
// blocks, as a film merged from shards has them, are a block together.
void Rendering::begin_blocks() {
  const uint64_t done = film_.samples(), fourth = render_state_.goal / 4;
  PictureBlocks& blocks = render_state_.blocks;
  if (done == 0 && session_.renderer.on_device() && fourth > 1)
    blocks = PictureBlocks(std::bit_floor(fourth), {}, {});
  if (done > blocks.next()) blocks = PictureBlocks(done, {}, {});
  look();
}

// Where a block ends.
void Rendering::look() {
  if (film_.samples() != render_state_.blocks.next()) return;
  render_state_.blocks.add(film_.sums(watched_step(film_)));
  const std::optional<Noise> noise = noise_of(film_, render_state_.blocks);
  noise_words_ = noise ? fmt::format("relMSE about {}", number_words(noise->relmse, 2)) : "";
}

TargetProgress Rendering::stand() const {
  return {film_.samples(),      render_state_.goal,  result_.interrupted,
          render_state_.blocks, render_state_.pilot, result_.noise};
}

// "relMSE about 0.02", predicted by the pilot, or estimated from the picture.
std::string Rendering::error_so_far() const {
  if (!render_state_.target) return noise_words_;
  if (render_state_.pilot.rounds.empty() || film_.samples() == 0) return "";
  const ErrorPilot::Round& round = render_state_.pilot.about(film_.samples());
  if (!(round.estimate.relmse > 0)) return "";
  const double of = static_cast<double>(round.samples) / static_cast<double>(film_.samples());
  return fmt::format("relMSE about {}", number_words(round.estimate.relmse * of, 2));
}

void Rendering::record_frame() {
  WorkClock& clock = session_.clock;
  const double seconds = clock.seconds(), cpu = clock.cpu();
  clock.aside([&] {
    const Picture picture = film_.picture();
    render_state_.frames.push_back(
        {film_.samples(), nonzero_of(picture), mean_of(picture), seconds, cpu});
    framed_ = film_.samples();
  });
}

// Samples in the next pass; 0: the picture is done, or the time is up.
uint64_t Rendering::next_pass() const {
  const uint64_t done = film_.samples(), goal = render_state_.goal;
  if (goal > 0 && done >= goal) return 0;
  const uint64_t most =
      std::max<uint64_t>(session_.renderer.samples_of_pass() / session_.pixels, 1);
  uint64_t n = goal == 0 ? most : std::min(most, goal - done);
  n = std::min(n, render_state_.blocks.next() - done);
  if (settings_.frames) n = std::min(n, next_frame(framed_) - done);
  if (session_.longest == 0) return 0;
  if (settings_.seconds == 0) return n;
  if (done == 0) return 1;  // there must be a picture
  // Samples are expected to take as long as those before; stops nearest to the limit.
  const double now = session_.clock.seconds();
  const double per_sample = (now - render_state_.began) / static_cast<double>(done);
  const double in_time = (settings_.seconds - now) / per_sample;
  return in_time < 0.5 ? 0 : std::min(n, static_cast<uint64_t>(std::max(in_time, 1.0)));
}

// Each visitor gets at most a tenth of the time, however large the picture.
void Rendering::receive_visitors() {
  if (result_.cut_short) return;
  due_.resize(schedule_.visitors.size(), render_state_.began);
  for (size_t i = 0; i < due_.size(); ++i) {
    const RenderSchedule::Visitor& visitor = schedule_.visitors[i];
    const double now = session_.clock.seconds();
    if (now < due_[i] + visitor.every) continue;
    render_state_.seconds = now;
    render_state_.cpu_seconds = session_.clock.cpu();
    const auto before = std::chrono::steady_clock::now();
    session_.clock.aside([&] { visitor.visit(render_state_, result_.plan); });
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    due_[i] = now + std::max(0.0, 10 * took.count() - visitor.every);
  }
}

void Rendering::render_pass(uint64_t samples, Progress& progress) {
  try {
    session_.renderer.render(result_.plan.integrator, session_.rules, 0,
                             {render_state_.next(), samples}, film_, render_state_.tally, progress);
  } catch (const Error&) {
    render_state_.seconds = session_.clock.seconds();
    render_state_.cpu_seconds = session_.clock.cpu();
    if (schedule_.rescue && film_.samples() > 0 && !result_.cut_short)
      schedule_.rescue(render_state_, result_.plan);
    throw;
  }
}

void Rendering::render_goal() {
  const uint64_t goal = render_state_.goal;
  if (next_pass() > 0) session_.make_ready(result_.plan.integrator, film_);
  Progress progress("rendering", "samples",
                    (goal - std::min(goal, film_.samples())) * session_.pixels, settings_.quiet);
  if (goal == 0) progress.ends_after(settings_.seconds - session_.clock.seconds());
  if (const uint64_t all = std::max<uint64_t>(goal, 1);
      session_.longest == 0 && film_.samples() < all)
    film_.complete({render_state_.next(), all - film_.samples()});
  while (const uint64_t n = next_pass()) {
    // A signal after the last sample interrupts nothing, and there must be a picture.
    result_.interrupted = stop_requested() && film_.samples() > 0;
    if (result_.interrupted) break;
    progress.tell(error_so_far());
    render_pass(n, progress);
    look();
    if (settings_.frames && film_.samples() == next_frame(framed_)) record_frame();
    receive_visitors();
  }
  result_.noise = noise_of(film_, render_state_.blocks);
}

void Rendering::run() {
  render_goal();
  if (auto& target = render_state_.target) {
    judge(settings_, stand(), *target);
    if (const auto goal = goal_of_retry(settings_, stand(), *target)) {
      render_state_.goal = *goal;
      render_goal();
      judge(settings_, stand(), *target);
    }
  }
  result_.frames = render_state_.frames;
  if (!settings_.frames || (!result_.frames.empty() && framed_ == film_.samples())) return;
  record_frame();  // the last one, which is none of those that are recorded on the way
  std::swap(result_.frames, render_state_.frames);
}

std::shared_ptr<RenderState> beginning(const Session& session,
                                       const std::vector<Candidate>& candidates,
                                       RenderSchedule& schedule) {
  if (schedule.render_state)
    return std::make_shared<RenderState>(std::move(*schedule.render_state));
  const FilmPlane& film = session.world.film;
  return std::make_shared<RenderState>(
      Film(film.width(), film.height(), session.world.lights.power(),
           film_options(candidates, session.settings)),
      session.settings);
}

// For a new picture, or a part of one.
void take_count(const SampleCount& count, const RenderSchedule& schedule,
                RenderState& render_state) {
  render_state.goal = count.goal;
  render_state.target = count.target_at_start;
  render_state.pilot = count.pilot;
  if (schedule.part.count == 0) return;
  render_state.first = schedule.part.first;
  render_state.goal = schedule.part.count;
  render_state.whole = schedule.whole;
}

// What was told when the picture was begun.
void take_measured(const Measured& measured, size_t candidates, Measured& result) {
  const size_t estimates = measured.forecast.estimates.size();
  if (estimates == 0 || estimates == candidates) result = measured;
}

// Fills in the result when all is rendered.
void finish(const Session& session, RenderResult& result) {
  RenderState& render_state = *result.render_state;
  render_state.seconds = result.seconds = session.clock.seconds();
  render_state.cpu_seconds = result.cpu_seconds = session.clock.cpu();
  result.spp = render_state.film.samples();
  result.tally.add(render_state.tally);
  // A rendering that its time limit ended is complete.
  if (render_state.goal == 0 && !result.interrupted) render_state.goal = result.spp;
  result.target = render_state.target;
  result.picture = render_state.film.picture();
  for (size_t i = 0; i < kTechniques; ++i)
    if (render_state.film.has_layer(i))
      result.layers[kTechniqueNames[i]] = render_state.film.layer(i);
}

}  // namespace

RenderResult render(SampleRenderer& renderer, const std::vector<Candidate>& given,
                    const RenderSettings& settings, const Known& known, RenderSchedule schedule) {
  RenderResult result;
  result.renderer = renderer.name();
  const bool goes_on = schedule.render_state.has_value();
  Session session(renderer, settings, goes_on ? schedule.render_state->seconds : 0,
                  goes_on ? schedule.render_state->cpu_seconds : 0);
  const auto candidates = expecting_connections(session.world, given, settings.max_depth);
  result.render_state = beginning(session, candidates, schedule);
  RenderState& render_state = *result.render_state;
  static_cast<Decision&>(result) = schedule.plan
                                       ? obeyed(*schedule.plan, session, candidates)
                                       : decided(session, candidates, known, render_state.film);
  if (goes_on && render_state.measured)
    take_measured(*render_state.measured, candidates.size(), result);
  else if (!schedule.plan)
    render_state.measured.emplace(result);
  if (!goes_on) take_count(result.count, schedule, render_state);
  if (!goes_on) render_state.began = session.clock.seconds();
  Rendering(session, schedule, result).run();
  finish(session, result);
  return result;
}

RenderResult decide(SampleRenderer& renderer, const std::vector<Candidate>& given,
                    const RenderSettings& settings, const Known& known) {
  RenderResult result;
  result.renderer = renderer.name();
  Session session(renderer, settings);
  const auto candidates = expecting_connections(session.world, given, settings.max_depth);
  RenderSchedule none;
  const auto render_state = beginning(session, candidates, none);
  static_cast<Decision&>(result) = decided(session, candidates, known, render_state->film);
  result.target = result.count.target_at_start;
  result.seconds = session.clock.seconds();
  result.cpu_seconds = session.clock.cpu();
  return result;
}

RenderResult render(SampleRenderer& renderer, const Integrator& integrator,
                    const RenderSettings& settings) {
  return render(renderer, std::vector<Candidate>{{integrator, integrator.name}}, settings);
}

RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings) {
  CpuRenderer cpu(world);
  return render(cpu, candidates, settings);
}

RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings) {
  return render(world, std::vector<Candidate>{{integrator, integrator.name}}, settings);
}

}  // namespace tdpt
