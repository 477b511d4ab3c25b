#include "tools/tdpt-render/run/render.h"

#include <array>
#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"

namespace tdpt {
namespace {

// ---- The target error ----

using Stop = TargetOutcome::Stop;

// Indexed by Stop.
constexpr std::array kStops{"target", "spp", "time", "signal", "no light"};

// Blocks of that many samples are trusted more than a pilot in any case.
constexpr uint64_t kTelling = 8;

const char* stop_of(const TargetOutcome& target) {
  return kStops[static_cast<size_t>(target.stop)];
}

ErrorEstimate estimate_of(const PictureBlocks& blocks) {
  return blocks.blocks().size() > 2 ? estimate_error(blocks.blocks(), blocks.size())
                                    : ErrorEstimate{.samples = blocks.size()};
}

Stop stop_of(const Progress& progress, uint64_t fixed) {
  const uint64_t samples = progress.film.samples();
  if (progress.interrupted) return Stop::signal;
  if (progress.goal == 0 || samples < progress.goal) return Stop::time;
  if (progress.goal == progress.in_force().spp && fixed != progress.goal) return Stop::spp;
  return fixed > 0 ? Stop::fixed : Stop::unlit;
}

// What the picture's blocks show, or the pilot's parts, if the blocks' estimate does not suffice or
// there are fewer than three.
std::optional<Noise> noise_of_parts(const std::vector<ErrorEstimate>& rounds,
                                    const Progress& progress) {
  const uint64_t samples = progress.film.samples();
  ErrorEstimate estimate = estimate_of(progress.blocks);
  if (!tells(estimate) && estimate.samples < kTelling && !rounds.empty()) {
    const ErrorEstimate& round = best_round(rounds, samples);
    if (round.lit && (tells(round) || round.samples > estimate.samples || !estimate.lit))
      estimate = round;
  }
  if (!estimate.lit) return {};
  const double relmse =
      estimate.relmse * static_cast<double>(estimate.samples) / static_cast<double>(samples);
  const double factor = interval_factor(estimate);
  return Noise{relmse, relmse / factor, relmse * factor};
}

// "about 0.0093 [0.0088, 0.0098]".
std::string estimate_of(const TargetOutcome& target) {
  if (!target.noise) return "not known";
  return fmt::format("about {} [{}, {}]", number_words(target.noise->relmse, 2),
                     number_words(target.noise->low, 2), number_words(target.noise->high, 2));
}

}  // namespace

std::optional<TargetOutcome> judge(const Session& session, const Plan& plan,
                                   const Progress& progress, const std::optional<Noise>& noise) {
  TargetOutcome target;
  target.error = progress.in_force().target_error;
  if (target.error == 0) return {};
  target.dark = session.is_dark();
  target.fixed = target.dark ? plan.spp : progress.retried > 0 ? progress.retried : plan.needed;
  target.stop = stop_of(progress, target.fixed);
  target.noise = noise ? noise : noise_of_parts(plan.error_rounds, progress);
  return target;
}

bool raise_goal(TargetOutcome& target, Progress& progress) {
  const Limits& limits = progress.limits;
  if (!limits.retry || progress.retried > 0) return false;
  const PictureBlocks& blocks = progress.blocks;
  const ErrorEstimate estimate = estimate_of(blocks);
  const bool known = tells(estimate) || (estimate.lit && blocks.size() >= kTelling);
  if (target.stop != Stop::fixed || target.reached() || !known) return false;
  const uint64_t needed = samples_needed(estimate, blocks.blocks().size(), target.error);
  const uint64_t goal = limits.spp > 0 ? std::min(needed, limits.spp) : needed;
  if (goal <= progress.film.samples()) {
    if (needed > goal) target.stop = Stop::spp;
    return false;
  }
  progress.retried = needed;
  progress.goal = goal;
  return true;
}

std::string target_sentence(const TargetOutcome& target, const Progress& progress) {
  const std::string aim = fmt::format("target relMSE {} ", number_words(target.error));
  if (target.dark) return aim + "reached: no light can come to the camera, the picture is black";
  const std::string got =
      fmt::format(": it is {} after {} per pixel{}", estimate_of(target),
                  counted(progress.film.samples(), "sample"),
                  progress.retried > 0 ? ", those of --set retry=1 among them" : "");
  if (target.reached()) return aim + "reached" + got;
  const std::string enough =
      target.fixed > 0 ? fmt::format("; {} would do", target.fixed) : std::string();
  switch (target.stop) {
    case Stop::spp:
      return aim + "not reached, stopped by --spp" + got + enough;
    case Stop::time:
      return aim + "not reached, stopped by --time" + got + enough;
    case Stop::signal:
      return aim + "not reached, stopped by a signal" + got + enough;
    case Stop::unlit:
      return aim + "not reached, too little light was met to tell how many samples it takes" + got;
    case Stop::fixed:
      break;
  }
  return aim + "missed" + got + (!progress.limits.retry ? "; --set retry=1 renders on" : "");
}

nlohmann::ordered_json target_json(const TargetOutcome& target, const Plan& plan,
                                   const Progress& progress) {
  nlohmann::ordered_json j{{"error", target.error},
                           {"reached", target.reached()},
                           {"stopped_by", stop_of(target)},
                           {"relmse", nullptr},
                           {"interval", nullptr}};
  if (target.dark) j["relmse"] = 0;
  if (target.noise) {
    j["relmse"] = target.noise->relmse;
    j["interval"] = {target.noise->low, target.noise->high};
  }
  j["fixed_spp"] = nullptr;
  if (target.fixed > 0) j["fixed_spp"] = target.fixed;
  j["retried"] = progress.retried > 0;
  j["pilot"] = {{"spp", plan.error_pilot_samples()}, {"cpu", plan.error_pilot_cpu_seconds}};
  return j;
}

std::map<std::string, std::string> target_attributes(const TargetOutcome& target) {
  return {{"targetError", fmt::format("{:.6g}", target.error)},
          {"estimatedError", target.dark ? "0" : estimate_of(target)},
          {"stoppedBy", stop_of(target)}};
}

// ---- Passes ----

namespace {

// Renders pass by pass.
class Rendering {
 public:
  Rendering(Session& session, const Plan& plan, Progress& progress,
            const std::function<void()>& between)
      : session_(session),
        plan_(plan),
        progress_(progress),
        film_(progress.film),
        between_(between),
        framed_(progress.frames.empty() ? film_.samples() : progress.frames.back().spp) {
    begin_blocks();
  }

  /// Until all samples are rendered or the time is up.
  void run(RenderResult& result);

 private:
  void begin_blocks();
  void end_block();
  uint64_t next_pass() const;
  void record_frame();
  void render_goal();
  void stop_clock();
  std::string error_so_far() const;

  Session& session_;
  const Plan& plan_;
  Progress& progress_;
  Film& film_;
  const std::function<void()>& between_;
  uint64_t framed_;          // samples when the last frame was recorded
  std::string noise_words_;  // as of the last block
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
  const std::optional<Noise> noise = noise_of(film_, progress_.blocks);
  noise_words_ = noise ? fmt::format("relMSE about {}", number_words(noise->relmse, 2)) : "";
}

// "relMSE about 0.02", predicted by the pilot, or estimated from the picture.
std::string Rendering::error_so_far() const {
  if (plan_.error_rounds.empty()) return noise_words_;
  if (film_.samples() == 0) return "";
  const ErrorEstimate& round = best_round(plan_.error_rounds, film_.samples());
  if (!(round.relmse > 0)) return "";
  const double of = static_cast<double>(round.samples) / static_cast<double>(film_.samples());
  return fmt::format("relMSE about {}", number_words(round.relmse * of, 2));
}

void Rendering::record_frame() {
  const double seconds = session_.seconds(), cpu = session_.cpu();
  session_.aside([&] {
    const Picture picture = film_.picture();
    progress_.frames.push_back(
        {film_.samples(), nonzero_of(picture), mean_of(picture), seconds, cpu});
    framed_ = film_.samples();
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
  if (session_.job.frames) n = std::min(n, next_frame(framed_) - done);
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
  if (next_pass() > 0) session_.make_ready(plan_.integrator, film_);
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
    session_.renderer.render(plan_.integrator, session_.rules, 0, {progress_.next(), n}, film_,
                             progress_.tally, bar);
    end_block();
    if (session_.job.frames && film_.samples() == next_frame(framed_)) record_frame();
    stop_clock();
    if (between_ && !plan_.cut_short) session_.aside(between_);
  }
}

void Rendering::run(RenderResult& result) {
  const auto judge_now = [&] {
    result.noise = noise_of(film_, progress_.blocks);
    result.target = judge(session_, plan_, progress_, result.noise);
  };
  render_goal();
  judge_now();
  if (result.target && raise_goal(*result.target, progress_)) {
    render_goal();
    judge_now();
  }
  result.frames = progress_.frames;
  if (session_.job.frames && (result.frames.empty() || framed_ != film_.samples())) {
    record_frame();  // the last one, which is none of those that are recorded on the way
    std::swap(result.frames, progress_.frames);
  }
  stop_clock();
  // A rendering that its time limit ended is complete.
  if (progress_.goal == 0 && !progress_.interrupted) progress_.goal = film_.samples();
  result.tally.add(progress_.tally);
  result.picture = film_.picture();
}

}  // namespace

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
  return progress;
}

RenderResult render(Session& session, const Plan& plan, std::shared_ptr<Progress> progress,
                    const std::function<void()>& between) {
  RenderResult result;
  result.plan = plan;
  result.progress = std::move(progress);
  if (result.spp() == 0)
    result.progress->began = session.seconds();
  else
    session.add_time(result.progress->seconds, result.progress->cpu_seconds);
  Rendering(session, plan, *result.progress, between).run(result);
  return result;
}

}  // namespace tdpt
