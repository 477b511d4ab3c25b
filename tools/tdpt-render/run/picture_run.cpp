#include "tools/tdpt-render/run/picture_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/processor.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/ending.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/run/choice.h"
#include "tools/tdpt-render/run/delivery.h"
#include "tools/tdpt-render/run/explain.h"
#include "tools/tdpt-render/run/portal_report.h"
#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/run/seen_backs.h"
#include "tools/tdpt-render/run/target_report.h"

namespace tdpt {
namespace {

// Samples per pixel if no option sets them.
constexpr cli::ByQuality<uint64_t> kSamples{4, 16, 64};

RenderSettings settings_of(const Arguments& a, const cli::Common& common) {
  RenderSettings settings;
  const bool unlimited = a.spp == 0 && a.seconds == 0 && a.target_error == 0;
  settings.spp = unlimited ? kSamples.at(common.quality) : static_cast<uint64_t>(a.spp);
  settings.target_error = a.target_error;
  settings.retry = a.retry > 0;
  settings.seconds = a.seconds;
  settings.max_depth = a.max_depth == 0 ? kMaxDepth : static_cast<int>(a.max_depth);
  settings.beta = a.mis == "power" ? 2 : 1;
  settings.seed = common.seed;
  settings.quiet = common.quiet;
  settings.alpha = a.alpha;
  settings.layers = a.layers;
  settings.halves = keeps_halves(a);
  settings.frames = !a.stats.empty();
  settings.fixed = !a.plan.empty() || a.frame;
  return settings;
}

// Share of the light carried by portal segments; 1 if that technique is not used.
double share_of_portals(const World& world, const Integrator& integrator,
                        const RenderResult& result) {
  if (world.portals.empty() || !integrator.mixture.has(Technique::portal) || result.longest)
    return 1;
  const RenderTally& tally = result.tally;
  const double total = std::accumulate(tally.energy.begin(), tally.energy.end(), 0.0);
  return total > 0 ? tally.energy[static_cast<size_t>(Technique::portal)] / total : 1;
}

bool is_black(const RenderResult& result) {
  return !result.cut_short && nonzero_of(result.picture) == 0;
}

void report(const Job& job, const World& world, const Choice& choice, const RenderResult& result,
            const Delivered& delivered) {
  const cli::Common& common = job.common;
  const Loaded& in = job.in;
  const RenderSettings& settings = job.settings;
  common.summary(
      finished_json(summary_json(choice.integrator, settings, result, in.portals), delivered));
  for (const Tally::SamplePixel& place : result.tally.not_finite_at)
    common.warn(fmt::format(
        "{}pixel {} {} sample {}: a contribution was not finite, or beyond what a splat "
        "holds, and is left out",
        job.a.of_frame(), place.x, place.y, place.sample));
  if (job.a.frame) return;  // a shot has a line for each of its frames
  // Else the cause was told before, or the sky is left out, or longer paths are.
  if (is_black(result) && !result.longest && !settings.alpha && settings.max_depth == kMaxDepth)
    common.warn(
        "no sample found light: the picture is black; are they too few, is a door shut, or does "
        "its "
        "camera stand in a wall?");
  if (const double share =
          share_of_portals(world, choice.candidates[result.chosen].integrator, result);
      share < kLeastEnergy)
    common.note(idleness(share));
  else if (const std::string useless = useless_portals(in.portals, result); !useless.empty())
    common.note(useless);
  const std::string name =
      result.chosen_label.empty() ? choice.integrator.name : result.chosen_label;
  const std::string of = job.is_shard() ? " of the shard" : "";
  common.note(fmt::format("{}: {} per pixel{} at {} x {} in {:.1f} s ({:.1f} CPU s)", name,
                          counted(result.spp, "sample"), of, result.picture.width,
                          result.picture.height, result.seconds, result.cpu_seconds));
  if (result.interrupted)
    common.note("stopped by a signal; the picture holds the samples named above");
  if (result.cut_short && !(job.checkpoint() + job.a.plan).empty())
    common.note("not all was decided before the signal: no plan and no checkpoint is kept");
  if (result.target)
    common.note(target_sentence(*result.target, result.spp));
  else if (!is_black(result) && !result.cut_short && (result.noise || !result.longest))
    common.note((job.a.filters() ? "before filtering " : "") +
                noise_sentence(result.noise, result.seconds));
  if (const std::string length = length_sentence(settings, result); !length.empty())
    common.note(length);
}

// A job, and what it takes to render it.
struct Prepared {
  Job job;
  World& world;
  Choice choice;
  std::shared_ptr<SampleRenderer> renderer;
};

// --plan without rendering: writes what was decided and reports where it was written.
int write_plan(const Job& job, SampleRenderer& renderer, const Choice& choice) {
  const std::vector<Portal>& portals = job.in.portals;
  const RenderResult decided = decide(renderer, choice.candidates, job.settings, choice);
  const Plan& plan = decided.plan;
  if (stop_requested()) {
    job.common.note("stopped by a signal; no plan is written");
    return static_cast<int>(Exit::interrupted);
  }
  const std::string told = plan_json(decided, portals);
  cli::deliver({{job.a.plan,
                 [&] {
                   return plan_file_text({plan, job.shape, job.common.command});
                 }},
                {job.a.stats, [&] { return told + '\n'; }}},
               job.common);
  if (job.common.json) std::fputs((told + '\n').c_str(), stdout);  // no picture goes there
  job.common.note(fmt::format("{} will render {} per pixel at {} x {}", plan.label,
                              counted(plan.spp, "sample"), job.in.size.width, job.in.size.height));
  job.common.explain_by([&] {
    return decisions_of_plan({renderer.world, portals, job.request, choice, job.settings, decided});
  });
  return 0;
}

void warn_of_processors(const Job& job) {
  const std::string& before = job.given.processor;
  if (!before.empty() && before != job.code)
    job.common.warn(other_code_sentence(display_name(job.a.resume), before, job.code));
}

constexpr double kPreviewEvery = 5, kCheckpointEvery = 60;  // seconds

// Observers of the unfinished picture.
void add_visitors(const Job& job, const Choice& choice, RenderSchedule& schedule) {
  const double every = job.a.checkpoint_every < 0 ? kCheckpointEvery : job.a.checkpoint_every;
  if (!job.checkpoint().empty())
    schedule.visitors.push_back({every, [&](RenderState& render_state, const Plan& plan) {
                                   save({job, choice, render_state, plan});
                                 }});
  if (!job.a.preview.empty())
    schedule.visitors.push_back({kPreviewEvery, [&](RenderState& render_state, const Plan&) {
                                   show(job, render_state.film.picture());
                                 }});
}

// If the device is lost, what has been rendered is kept where a checkpoint can hold it.
RenderResult rendered(const Job& job, SampleRenderer& renderer, const Choice& choice,
                      RenderSchedule schedule) {
  add_visitors(job, choice, schedule);
  bool kept = false;
  if (!job.checkpoint().empty())
    schedule.rescue = [&](RenderState& render_state, const Plan& plan) {
      kept = save({job, choice, render_state, plan});
    };
  try {
    return render(renderer, choice.candidates, job.settings, choice, std::move(schedule));
  } catch (const Error& e) {
    if (!kept) throw;
    throw Error(e.code, fmt::format("{}; what was rendered is in {}: --resume goes on from it",
                                    e.what(), display_name(job.checkpoint())));
  }
}

// "16 samples per pixel in 3 s, relMSE about 0.012".
std::string told_of(const RenderResult& result) {
  std::string noise;
  if (is_black(result))
    noise = ", all black: are they too few, is a door shut, or does the camera stand in a wall?";
  else if (result.noise)
    noise = ", " + words_of(*result.noise);
  return fmt::format("{} per pixel in {}{}", counted(result.spp, "sample"),
                     duration_words(result.seconds), noise);
}

// How a rendering ended; `result` says the rest.
int code_of(const RenderResult& result) {
  return static_cast<int>(result.interrupted ? Exit::interrupted : Exit::done);
}

Outcome outcome_of(const Prepared& p, const RenderResult& result) {
  return {p.job,
          p.choice,
          *result.render_state,
          result.plan,
          result.target,
          channels_of(p.job, p.world),
          result.interrupted && !p.job.mark.empty() ? kIncomplete : p.job.mark};
}

// Of a frame in which nothing has moved: takes over what was rendered of it before.
void accumulate(Workshop& shop, Job& job) {
  const Arguments& a = job.a;
  RenderSchedule& schedule = job.given.schedule;
  auto still = std::exchange(shop.still, {});
  if (a.frames_held() == 1 || !schedule.plan || schedule.render_state) return;
  const uint64_t all = samples_of(*schedule.plan, a);
  schedule.plan->spp = job.settings.spp = all;
  if (!still || still->since != a.since) return;
  still->plan.spp = all;
  RenderState& before = *still->render_state;
  if (!(still->plan == *schedule.plan) || before.film.samples() > all) return;
  before.goal = before.limits.spp = all;
  before.seconds = before.cpu_seconds = before.began = 0;  // of this frame
  before.frames.clear();
  schedule.render_state.emplace(std::move(before));
}

// For the next frame.
void keep_still(const Job& job, const RenderResult& result, Workshop& shop) {
  if (job.a.accumulate && !result.interrupted)
    shop.still = {job.a.since, result.plan, result.render_state};
}

Made render(Prepared& p, Workshop& shop) {
  const Job& job = p.job;
  const std::vector<Portal>& portals = job.in.portals;
  const RenderResult result = rendered(job, *p.renderer, p.choice, std::move(p.job.given.schedule));
  if (const std::string verdict = verdict_sentence(result); !verdict.empty())
    job.common.note(verdict);
  if (job.request.automatic && result.render_state->measured)
    job.common.note(choice_sentence(result));
  if (result.cut_short && job.is_shard()) {
    job.common.note("stopped by a signal before all was decided: no shard is written");
    return {static_cast<int>(Exit::interrupted), ""};
  }
  const Delivered delivered = deliver(outcome_of(p, result), result);
  report(job, p.world, p.choice, result, delivered);
  if (!delivered.filtered.empty()) job.common.note(delivered.filtered);
  job.common.explain_by([&] {
    return with_exposure(
        decisions_of({p.world, portals, job.request, p.choice, job.settings, result}),
        job.a.exposure, delivered.exposure);
  });
  keep_still(job, result, shop);
  return {code_of(result), told_of(result)};
}

}  // namespace

Shaping shaping_of(const Loaded& in, const Arguments& a, const cli::Common& common) {
  return {in.scene,         in.sky,        camera_words(a, in.scene.frame, in.camera),
          in.portal_hashes, in.size.width, in.size.height,
          common.seed};
}

std::string Workshop::code() const {
  return device ? kGpuCode : processor_code();
}

namespace {

Prepared prepared(const Arguments& a, const cli::Common& common, Workshop& shop,
                  const PlanFile* plan, const std::string& mark) {
  cli::Common about_shot = common;  // of a frame nothing is told that holds for the shot
  about_shot.quiet = common.quiet || a.frame;
  if (shop.still && shop.still->since != a.since) shop.still.reset();  // frees its memory
  Loaded& in = shop.scenery.load(a, common);
  World& world = shop.scenery.world(common);
  Job job{a, common, in, request_of(a), settings_of(a, common), {}, {}, {}, mark, shop.code()};
  std::optional<GpuUpload> upload;
  if (shop.device)
    upload.emplace(*shop.device, world, FilmPlanes{job.settings.layers, job.settings.halves});
  if (const std::string sentence = no_backs_sentence(world); !sentence.empty())
    about_shot.note(sentence);
  const Shaping by = shaping_of(in, a, common);
  job.shape = plan_shape_of(a, by);
  job.film_shape = film_shape_of(a, by);
  job.given = read_checkpoint(a, by, world, plan, job.settings);
  warn_of_processors(job);
  if (const auto& render_state = job.given.schedule.render_state)
    common.note(fmt::format("goes on from {}, which has {} of {} samples per pixel",
                            display_name(a.resume), render_state->film.samples(),
                            std::max(render_state->goal, render_state->film.samples())));
  std::optional<Plan>& planned = job.given.schedule.plan;
  const auto chosen = [&]() -> Choice {
    if (planned && a.portals_by_frame && !job.given.schedule.render_state)
      return choose_for_frame(*planned, job.request, job.settings, in.camera, world, in.portals,
                              about_shot);
    if (planned)
      return choose_as_planned(*planned, job.given.plan_file, job.request, job.settings, world,
                               in.portals, about_shot);
    return choose(job.request, job.settings, in.camera, world, in.portals, about_shot);
  };
  Choice choice = chosen();
  auto renderer = upload ? upload->renderer() : std::make_shared<CpuRenderer>(world);
  if (shop.device && !std::exchange(shop.told, true))
    common.note("samples are rendered by " + words_of(shop.device->info()) + ".");
  accumulate(shop, job);
  check_film(job.given, film_options(choice.candidates, job.settings));
  return {std::move(job), world, std::move(choice), std::move(renderer)};
}

}  // namespace

Made render_picture(const Arguments& a, const cli::Common& common, Workshop& shop,
                    const PlanFile* plan, const std::string& mark) {
  if (a.check) {
    shop.scenery.load(a, common);
    request_of(a), settings_of(a, common);  // throw for what they cannot be made of
    return {};
  }
  Prepared p = prepared(a, common, shop, plan, mark);
  if (p.job.only_plans()) return {write_plan(p.job, *p.renderer, p.choice), ""};
  return render(p, shop);
}

MadeNoisy render_noisy(const Arguments& a, const cli::Common& common, Workshop& shop,
                       const PlanFile* plan, const std::string& mark) {
  Prepared p = prepared(a, common, shop, plan, mark);
  const RenderResult result =
      rendered(p.job, *p.renderer, p.choice, std::move(p.job.given.schedule));
  MadeNoisy made{{code_of(result), told_of(result)}, {}};
  if (result.interrupted) {
    if (!p.job.checkpoint().empty() && !result.cut_short) save(outcome_of(p, result));
    return made;
  }
  made.picture = hand_over(outcome_of(p, result), result);
  report(p.job, p.world, p.choice, result, {});
  keep_still(p.job, result, shop);
  return made;
}

DecidedFrame decide_frame(const Arguments& a, const cli::Common& common, Workshop& shop) {
  const Prepared p = prepared(a, common, shop, nullptr, "");
  const RenderResult decided = decide(*p.renderer, p.choice.candidates, p.job.settings, p.choice);
  if (p.job.request.automatic) common.note(a.of_frame() + choice_sentence(decided));
  DecidedFrame frame{{*a.frame, {{decided.plan}}}, p.job.shape};
  // A number of samples that was measured belongs to the candidate that it was measured with.
  const std::vector<CandidateEstimate>& all = decided.forecast.estimates;
  if (all.empty() || decided.count.measured) return frame;
  const auto candidates =
      expecting_connections(p.world, p.choice.candidates, p.job.settings.max_depth);
  frame.key.offers.clear();
  for (size_t i = 0; i < all.size(); ++i) {
    Plan plan = decided.plan;
    plan.integrator = candidates[i].integrator;
    plan.label = candidates[i].label;
    if (std::isfinite(all[i].cost)) frame.key.offers.push_back({plan, all[i].cost});
  }
  return frame;
}

}  // namespace tdpt
