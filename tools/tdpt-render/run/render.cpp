#include "tools/tdpt-render/run/render.h"

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
        framed_(film_.samples()) {
    const uint64_t done = film_.samples(), goal = render_state_.goal;
    const bool unstopped = session.renderer.on_device() && goal > done;
    if (!render_state_.watch) render_state_.watch.emplace(film_, unstopped ? goal - done : 0);
  }

  /// Until all samples are rendered or the time is up.
  void run();

 private:
  uint64_t next_pass() const;
  void receive_visitors();
  void render_pass(uint64_t samples, Progress& progress);
  void record_frame();
  void render_goal();
  TargetProgress stand() const;
  std::string error_so_far() const;
  NoiseWatch& watch() const { return *render_state_.watch; }

  Session& session_;
  const RenderSettings& settings_;
  const RenderSchedule& schedule_;
  RenderResult& result_;
  RenderState& render_state_;
  Film& film_;
  uint64_t framed_;          // samples when the last frame was recorded
  std::vector<double> due_;  // when each visitor's period last began [s]
};

TargetProgress Rendering::stand() const {
  return {film_.samples(), render_state_.goal, result_.interrupted, render_state_.blocks,
          render_state_.pilot};
}

// "relMSE about 0.02", predicted by the pilot, or estimated from the picture.
std::string Rendering::error_so_far() const {
  if (!render_state_.target) {
    const std::optional<Noise> noise = watch().noise(film_);
    return noise && noise->tells ? fmt::format("relMSE about {}", number_words(noise->relmse, 2))
                                 : "";
  }
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
    result_.frames.push_back(
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
  n = std::min(n, (render_state_.target ? render_state_.blocks.next() : watch().next()) - done);
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
    if (render_state_.target) {
      if (film_.samples() == render_state_.blocks.next()) render_state_.blocks.add(film_.sums());
    } else if (film_.samples() == watch().next()) {
      watch().look(film_);
    }
    if (settings_.frames && film_.samples() == next_frame(framed_)) record_frame();
    receive_visitors();
  }
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
  } else {
    result_.noise = watch().noise(film_);
  }
  const std::vector<FrameRecord>& frames = result_.frames;
  if (settings_.frames && (frames.empty() || frames.back().spp != film_.samples())) record_frame();
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
