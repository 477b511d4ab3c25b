#include "tools/tdpt-render/run/render.h"

#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/process.h"
#include "libcommon/base/words.h"

namespace tdpt {
namespace {

// ---- The target error ----

// Of the picture, as the pilot's parts predict it: relMSE falls at least as 1 / samples.
std::optional<Noise> predicted_noise(const ErrorPilot& pilot, uint64_t samples) {
  if (pilot.needed == 0 || samples == 0) return {};
  const ErrorEstimate& parts = pilot.estimate;
  const double relmse =
      parts.relmse * static_cast<double>(parts.samples) / static_cast<double>(samples);
  const double factor = interval_factor(parts);
  return Noise{relmse, relmse / factor, relmse * factor};
}

const char* stop_of(const Progress& progress, uint64_t fixed) {
  const uint64_t samples = progress.film.samples();
  if (progress.interrupted) return "signal";
  if (progress.goal == 0 || samples < progress.goal) return "time";
  if (progress.goal == progress.in_force().spp && fixed != progress.goal) return "spp";
  return fixed > 0 ? "target" : "no light";
}

// If there is a target. `noise`: of the picture, if it is known; else what the pilot predicts.
std::optional<TargetOutcome> target_outcome(const Session& session, const Progress& progress,
                                            const std::optional<Noise>& noise) {
  TargetOutcome target;
  target.error = progress.in_force().target_error;
  if (target.error == 0) return {};
  target.dark = session.is_dark();
  target.fixed = target.dark ? progress.goal : progress.error_pilot.needed;
  target.stopped_by = stop_of(progress, target.fixed);
  target.noise = noise ? noise : predicted_noise(progress.error_pilot, progress.film.samples());
  return target;
}

// "about 0.0093 [0.0088, 0.0098]".
std::string estimate_words(const TargetOutcome& target) {
  if (!target.noise) return "not known";
  return fmt::format("about {} [{}, {}]", number_words(target.noise->relmse, 2),
                     number_words(target.noise->low, 2), number_words(target.noise->high, 2));
}

}  // namespace

std::string target_sentence(const TargetOutcome& target, uint64_t spp) {
  const std::string aim = fmt::format("target relMSE {} ", number_words(target.error));
  if (target.dark) return aim + "reached: no light can come to the camera, the picture is black";
  const std::string got =
      fmt::format(": it is {} after {} per pixel", estimate_words(target), counted(spp, "sample"));
  const std::string& stop = target.stopped_by;
  if (target.reached()) return aim + "reached" + got;
  if (stop == "target") return aim + "missed" + got;
  if (stop == "no light")
    return aim + "not reached, too little light was met to tell how many samples it takes" + got;
  return fmt::format("{}not reached, stopped by {}{}{}", aim,
                     stop == "signal" ? "a signal" : "--" + stop, got,
                     target.fixed > 0 ? fmt::format("; {} would do", target.fixed) : "");
}

nlohmann::ordered_json target_json(const TargetOutcome& target, const ErrorPilot& pilot) {
  nlohmann::ordered_json j{
      {"error", target.error}, {"reached", target.reached()}, {"stopped_by", target.stopped_by},
      {"relmse", nullptr},     {"interval", nullptr},         {"fixed_spp", nullptr}};
  if (target.dark) j["relmse"] = 0;
  if (target.noise) {
    j["relmse"] = target.noise->relmse;
    j["interval"] = {target.noise->low, target.noise->high};
  }
  if (target.fixed > 0) j["fixed_spp"] = target.fixed;
  j["pilot"] = {{"spp", pilot.samples()}, {"cpu", pilot.cpu_seconds}};
  return j;
}

std::map<std::string, std::string> target_attributes(const TargetOutcome& target) {
  return {{"targetError", fmt::format("{:.6g}", target.error)},
          {"estimatedError", target.dark ? "0" : estimate_words(target)},
          {"stoppedBy", target.stopped_by}};
}

// ---- Passes ----

namespace {

// Renders pass by pass.
class Rendering {
 public:
  Rendering(Session& session, RenderResult& result, const std::function<void()>& between)
      : session_(session),
        result_(result),
        progress_(*result.progress),
        film_(progress_.film),
        between_(between),
        recorded_(film_.samples()) {
    begin_blocks();
  }

  /// Until all samples are rendered or the time is up.
  void render_goal();

 private:
  void begin_blocks();
  void end_block();
  uint64_t next_pass() const;
  void record_frame();
  void stop_clock();
  std::string error_so_far() const;

  Session& session_;
  RenderResult& result_;
  Progress& progress_;
  Film& film_;
  const std::function<void()>& between_;
  uint64_t recorded_;           // samples when the last frame was recorded
  std::optional<Noise> noise_;  // as of the last block
};

// A device would rather not be stopped: its first block is a fourth of the picture. Samples without
// blocks, as a film merged from shards has them, are a block together.
void Rendering::begin_blocks() {
  const uint64_t done = film_.samples(), fourth = progress_.goal / 4;
  PictureBlocks& blocks = progress_.blocks;
  if (done == 0 && session_.renderer.on_device() && fourth > 1)
    blocks = PictureBlocks(std::bit_floor(fourth), {}, {});
  if (done > blocks.next()) blocks = PictureBlocks(done, {}, {});
  end_block();
}

// Where a block ends.
void Rendering::end_block() {
  if (film_.samples() != progress_.blocks.next()) return;
  progress_.blocks.add(film_.sums(watched_step(film_)));
  noise_ = noise_of(film_, progress_.blocks);
}

// "relMSE about 0.02", estimated from the picture, or predicted by the pilot.
std::string Rendering::error_so_far() const {
  const auto noise =
      noise_ ? noise_ : predicted_noise(progress_.error_pilot, progress_.film.samples());
  return noise ? fmt::format("relMSE about {}", number_words(noise->relmse, 2)) : "";
}

void Rendering::record_frame() {
  const double seconds = session_.seconds(), cpu = session_.cpu();
  session_.aside([&] {
    const Picture picture = film_.picture();
    result_.frames.push_back(
        {film_.samples(), nonzero_of(picture), mean_of(picture), seconds, cpu});
    recorded_ = film_.samples();
  });
}

// Samples in the next pass; 0: the picture is done, or the time is up.
uint64_t Rendering::next_pass() const {
  const uint64_t done = film_.samples(), goal = progress_.goal;
  if (goal > 0 && done >= goal) return 0;
  const uint64_t most =
      std::max<uint64_t>(session_.renderer.samples_of_pass() / session_.pixels, 1);
  uint64_t n = goal == 0 ? most : std::min(most, goal - done);
  n = std::min(n, progress_.blocks.next() - done);
  if (session_.job.frames) n = std::min(n, next_frame(recorded_) - done);
  if (session_.longest == 0) return 0;
  const double limit = progress_.in_force().seconds;
  if (limit == 0) return n;
  if (done == 0) return 1;  // there must be a picture
  // Samples are expected to take as long as those before; stops nearest to the limit.
  const double now = session_.seconds();
  const double per_sample = (now - progress_.began) / static_cast<double>(done);
  const double in_time = (limit - now) / per_sample;
  return in_time < 0.5 ? 0 : std::min(n, static_cast<uint64_t>(std::max(in_time, 1.0)));
}

void Rendering::stop_clock() {
  progress_.seconds = session_.seconds();
  progress_.cpu_seconds = session_.cpu();
}

void Rendering::render_goal() {
  const uint64_t goal = progress_.goal;
  if (next_pass() > 0) session_.make_ready(result_.plan.integrator, film_);
  ProgressBar bar("rendering", "samples",
                  (goal - std::min(goal, film_.samples())) * session_.pixels, session_.job.quiet);
  if (goal == 0) bar.ends_after(progress_.in_force().seconds - session_.seconds());
  if (const uint64_t all = std::max<uint64_t>(goal, 1);
      session_.longest == 0 && film_.samples() < all)
    film_.complete({progress_.next(), all - film_.samples()});
  while (const uint64_t n = next_pass()) {
    // A signal after the last sample interrupts nothing, and there must be a picture.
    progress_.interrupted = stop_requested() && film_.samples() > 0;
    if (progress_.interrupted) break;
    bar.tell(error_so_far());
    session_.renderer.render(result_.plan.integrator, session_.rules, 0, {progress_.next(), n},
                             film_, progress_.tally, bar);
    end_block();
    if (session_.job.frames && film_.samples() == next_frame(recorded_)) record_frame();
    stop_clock();
    if (between_ && !result_.plan.cut_short) session_.aside(between_);
  }
  result_.noise = noise_of(film_, progress_.blocks);
  if (session_.job.frames && (result_.frames.empty() || recorded_ != film_.samples()))
    record_frame();
  stop_clock();
}

}  // namespace

uint64_t next_frame(uint64_t spp) {
  return spp + std::max<uint64_t>(1, spp < 256 ? 1 : spp / 16);
}

Film::Options film_options(const Job& job, const std::vector<Candidate>& candidates) {
  TechniqueSet layers;
  if (job.layers)
    for (const Candidate& c : candidates) layers = layers | c.integrator.mixture.techniques;
  return film_options(layers, job.alpha, job.halves);
}

Progress new_progress(const Session& session, const std::vector<Candidate>& candidates,
                      const Plan& plan) {
  const FilmPlane& film = session.vista.view.film;
  Progress progress(Film(film.width(), film.height(), session.vista.world->lights.power(),
                         film_options(session.job, candidates)),
                    session.job.limits);
  progress.goal = plan.spp;
  progress.error_pilot = plan.error_pilot;
  return progress;
}

RenderResult render(Session& session, const Plan& plan, std::shared_ptr<Progress> progress,
                    const std::function<void()>& between) {
  RenderResult result;
  result.plan = plan;
  result.progress = std::move(progress);
  Progress& now = *result.progress;
  if (result.spp() == 0)
    now.began = session.seconds();
  else
    session.add_time(now.seconds, now.cpu_seconds);
  Rendering(session, result, between).render_goal();
  result.target = target_outcome(session, now, result.noise);
  // A rendering that its time limit ended is complete.
  if (now.goal == 0 && !now.interrupted) now.goal = now.film.samples();
  result.tally.add(now.tally);
  result.picture = now.film.picture();
  return result;
}

}  // namespace tdpt
