// tdpt-render: renders a glTF scene by path tracing, through portals where given.
#include <algorithm>
#include <filesystem>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/processor.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/built_with.h"
#include "libcommon/cli/cli.h"
#include "libcommon/cli/ending.h"
#include "libcommon/denoise/oidn.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/portals/given_portals.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/choice.h"
#include "tools/tdpt-render/run/covered_lamps.h"
#include "tools/tdpt-render/run/delivery.h"
#include "tools/tdpt-render/run/explain.h"
#include "tools/tdpt-render/run/picture_size.h"
#include "tools/tdpt-render/run/portal_report.h"
#include "tools/tdpt-render/run/render.h"
#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/run/seen_backs.h"
#include "tools/tdpt-render/run/target_report.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt-render",
    "Renders a glTF scene by (tri-directional) path tracing, with portals where "
    "there are any.",
    "Picture to write (OpenEXR); default standard output",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit};

// Samples per pixel if no option sets them.
constexpr cli::ByQuality<uint64_t> kSamples{4, 16, 64};

Loaded load(const Arguments& a, const cli::Common& common) {
  Loaded in;
  in.scene = read_gltf(a.scene, a.pose);
  common.also_read(in.scene.files);
  for (const std::string& warning : in.scene.warnings) common.warn_of(a.scene, warning);
  in.camera = chosen_camera(in.scene, a.camera, common);
  in.files.push_back({a.scene, in.scene.hash, {}});
  in.sky = add_sky(in.scene, a.sky, common, in.files);
  warn_of_lamps(in.scene, common);
  note_lost_light(in.scene, common);
  for (const std::string& path : a.portals) {
    const GivenPortals given = read_given_portals(path, in.scene, in.camera);
    for (const std::string& warning : first_few(given.warnings)) common.warn(warning);
    for (const std::string& note : first_few(given.notes)) common.note(note);
    const PortalFile& file = given.file;
    common.also_read(file.files);
    in.portals.insert(in.portals.end(), file.portals.begin(), file.portals.end());
    in.files.push_back({path, file.hash, file.provenance});
    in.portal_hashes.push_back(file.hash);
  }
  in.size = picture_size(in.scene, in.camera, a.width, a.height);
  return in;
}

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
  settings.fixed = !a.plan.empty();
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

void report(const Job& job, const World& world, const Choice& choice, const RenderResult& result,
            const Delivered& delivered) {
  const cli::Common& common = job.common;
  const Loaded& in = job.in;
  const RenderSettings& settings = job.settings;
  common.summary(summary_json(choice.integrator, settings, result, in.portals, delivered.exposure));
  for (const Tally::SamplePixel& place : result.tally.not_finite_at)
    common.warn(
        fmt::format("pixel {} {} sample {}: a contribution was not finite, or beyond what a splat "
                    "holds, and is left out",
                    place.x, place.y, place.sample));
  if (const double share =
          share_of_portals(world, choice.candidates[result.chosen].integrator, result);
      share < kLeastEnergy)
    common.note(idleness(in.portals, share));
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
  if (result.target) common.note(target_sentence(*result.target, result.spp));
  if (result.noise)
    common.note((job.a.filters() ? "before filtering " : "") +
                noise_sentence(*result.noise, result.seconds));
  if (const std::string length = length_sentence(settings, result); !length.empty())
    common.note(length);
}

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
  if (job.common.json) fmt::print("{}\n", told);  // no picture goes to standard output
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

int print_shards(const Arguments& a, const cli::Common& common) {
  const std::string commands = shard_commands(a, common.arguments, common.output);
  std::fputs(commands.c_str(), stdout);
  if (!a.plan.empty() && !std::filesystem::exists(a.plan))
    common.note("there is no " + a.plan + " yet: the same command without --shard and -o makes it");
  common.note("then merge them: " + merge_command(a, common.output));
  return 0;
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

int render(const Job& job, SampleRenderer& renderer, const Choice& choice,
           RenderSchedule schedule) {
  const World& world = renderer.world;
  const std::vector<Portal>& portals = job.in.portals;
  const RenderResult result = rendered(job, renderer, choice, std::move(schedule));
  if (const std::string verdict = verdict_sentence(result); !verdict.empty())
    job.common.note(verdict);
  if (job.request.automatic && !choice.planned) job.common.note(choice_sentence(result));
  if (result.cut_short && job.is_shard()) {
    job.common.note("stopped by a signal before all was decided: no shard is written");
    return static_cast<int>(Exit::interrupted);
  }
  const Delivered delivered = deliver(
      {job, choice, *result.render_state, result.plan, result.target, channels_of(job, world)},
      result);
  report(job, world, choice, result, delivered);
  if (!delivered.filtered.empty()) job.common.note(delivered.filtered);
  job.common.explain_by([&] {
    return with_exposure(decisions_of({world, portals, job.request, choice, job.settings, result}),
                         job.a.exposure, delivered.exposure);
  });
  return static_cast<int>(result.interrupted ? Exit::interrupted : Exit::done);
}

int run(const Arguments& a, const cli::Common& common) {
  check_render_arguments(a);
  if (!a.shard.empty()) check_stores_film(a, "--shard");
  const std::optional<gpu::Device> device = device_asked(a.device);
  if (prints_shards(a)) return print_shards(a, common);
  choose_processor_code(a.isa, common.arguments);
  if (a.denoiser == kDenoisers[1]) denoise::OpenImageDenoise();  // or there is no use in rendering
  check_schedule(a);
  catch_signals();
  Job job{a,
          common,
          load(a, common),
          request_of(a),
          settings_of(a, common),
          {},
          {},
          {},
          device ? kGpuCode : processor_code()};
  if (a.check) return 0;
  Loaded& in = job.in;
  const OpenWorld open = open_world(in.scene, in.camera, in.size.width, in.size.height, in.portals);
  if (open.uncovered > 0) common.warn(uncovered_sentence(open.uncovered, in.scene.frame));
  World& world = *open.world;
  std::optional<GpuUpload> upload;
  if (device) upload.emplace(*device, world, FilmPlanes{job.settings.layers, job.settings.halves});
  if (const std::string sentence = backs_sentence(seen_backs(world)); !sentence.empty())
    common.warn(sentence);
  if (const std::string sentence = no_backs_sentence(world); !sentence.empty())
    common.note(sentence);
  const Shaping by{in.scene,         in.sky,        camera_words(a, in.scene.frame, in.camera),
                   in.portal_hashes, in.size.width, in.size.height,
                   common.seed};
  job.shape = shape_of(a, by);
  job.film_shape = film_shape_of(a, by);
  job.given = read_checkpoint(a, by, world, obeys_plan(a, common.output_given), job.settings);
  warn_of_processors(job);
  if (const auto& render_state = job.given.schedule.render_state)
    common.note(fmt::format("goes on from {}, which has {} of {} samples per pixel",
                            display_name(a.resume), render_state->film.samples(),
                            std::max(render_state->goal, render_state->film.samples())));
  const std::optional<Plan>& plan = job.given.schedule.plan;
  const Choice choice =
      plan ? choose_as_planned(*plan, job.given.plan_file, job.request, job.settings, world,
                               in.portals, common)
           : choose(job.request, job.settings, in.camera, world, in.portals, common);
  const std::shared_ptr<SampleRenderer> renderer =
      device ? upload->renderer() : std::make_shared<CpuRenderer>(world);
  upload.reset();
  if (device) common.note("samples are rendered by " + words_of(device->info()) + ".");
  check_film(job.given, film_options(choice.candidates, job.settings));
  if (job.only_plans()) return write_plan(job, *renderer, choice);
  return render(job, *renderer, choice, std::move(job.given.schedule));
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
