#include "tools/tdpt-render/run/picture.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/gpu/device_options.h"
#include "libcommon/scene/uses.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/run/camera_sight.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/delivery.h"
#include "tools/tdpt-render/run/options.h"
#include "tools/tdpt-render/run/report.h"

namespace tdpt {
namespace {

// Throws InputError where a film was rendered by other portals or kinds of light than there are.
void check_explored(const Explored& explored, const Loaded& in, const Vista& vista,
                    const std::string& file) {
  if (explored.ways.size() > in.portals.size())
    throw InputError(file, "film.plan.portals", "speak of one that there is not");
  const Lights::KindProbabilities &then = explored.lights, now = vista.openings.selection.shares();
  const auto same = [](double x, double y) { return (x > 0) == (y > 0); };
  if (!same(then.surfaces, now.surfaces) || !same(then.lamps, now.lamps) ||
      !same(then.parallel, now.parallel) || !same(then.sky, now.sky))
    throw InputError(file, "film.plan.lights", "are of other lights");
}

// Portals work in the ways that light passes them, and kinds of light are selected by what arrives.
Vista explored_vista(const Explored& explored, Loaded& in, Vista vista) {
  if (explored.ways.empty() && explored.lights == vista.openings.selection.shares()) return vista;
  apply_ways(explored.ways, in.portals);
  vista.openings = Openings(*vista.world, in.portals, explored.lights, vista.openings.windows);
  return vista;
}

// Those of a new picture, which a resumed one keeps.
std::map<std::string, std::string> attributes_of(const RenderArguments& a,
                                                 const cli::Common& common, const Loaded& in,
                                                 const Job& job, const Integrator& asked,
                                                 const Plan& plan) {
  std::map<std::string, std::string> all;
  all["integrator"] = asked.name;
  if (job.automatic) all["chosen"] = plan.label;
  all["maxDepth"] = job.max_depth < kMaxDepth ? std::to_string(job.max_depth) : "none";
  all["seed"] = std::to_string(job.seed);
  all["mis"] = job.beta == 1 ? "balance" : "power";
  all["pixelFilter"] = "box, one pixel wide";
  all["colorSpace"] = "scene-linear Rec.709";
  all["camera"] = viewpoint_text(in.scene.frame, in.camera);
  if (a.lens.f_stop)
    all["lens"] = fmt::format("f/{} at {}", *a.lens.f_stop,
                              std::isinf(in.focus) ? "infinity" : fmt::format("{} m", in.focus));
  if (a.lens.shutter > 0) all["shutter"] = shutter_words(a.lens, a.shot);
  const Provenance provenance = common.provenance(in.files);
  if (!provenance.empty())
    all[provenance_attribute] = fmt::format("{}", fmt::join(provenance.lines, "\n"));
  return all;
}

// The statistics with what became of the picture after its last sample.
nlohmann::ordered_json finished(nlohmann::ordered_json stats, const Delivery::Finish& finish) {
  if (finish.exposure) stats["exposure"] = *finish.exposure;
  if (const auto& left = finish.left)
    stats["filtered"] = {{"relmse", left->relmse}, {"interval", {left->low, left->high}}};
  return stats;
}

// If the device is lost, what has been rendered is kept where a checkpoint can hold it.
RenderResult rendered(Session& session, const Plan& plan, std::shared_ptr<Progress> progress,
                      Delivery& files) {
  bool kept = false;
  const auto between = [&](const Plan& of, Progress& so_far) { files.renew(of, so_far); };
  const auto rescue = [&](const Plan& of, Progress& so_far) {
    if (!files.checkpoint().empty()) kept = files.save(of, so_far);
  };
  try {
    return render(session, plan, std::move(progress), between, rescue);
  } catch (const Error& e) {
    if (!kept) throw;
    throw Error(e.code, fmt::format("{}; what was rendered is in {}: --resume goes on from it",
                                    e.what(), display_name(files.checkpoint())));
  }
}

void tell_begun(const Begun& begun, const RenderArguments& a, const std::string& code,
                const cli::Common& common) {
  if (begun.processor != code)
    common.warn(other_code_sentence(display_name(a.resume), begun.processor, code));
  const uint64_t done = begun.progress->film.samples();
  common.note(fmt::format("goes on from {}, which has {} of {} samples per pixel",
                          display_name(a.resume), done, std::max(begun.progress->goal, done)));
}

}  // namespace

Fingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& portals,
                           const cli::Common& common, std::optional<int64_t> frame,
                           cli::Effect up_to) {
  Fingerprint facts{{"scene", scene.hash},
                    {"environment", scene.sky_hash},
                    {"portal", fmt::format("{}", fmt::join(portals, " "))}};
  if (frame) facts.emplace_back("frame", std::to_string(*frame));
  return common.fingerprint(facts, up_to);
}

std::string frame_mark(const Scene& scene, const std::vector<std::string>& portals,
                       const cli::Common& common, int64_t frame) {
  return fmt::format("{} {}", frame,
                     hash_of(fingerprint_of(scene, portals, common, frame, cli::Effect::stored)));
}

Made render_picture(const RenderArguments& a, const cli::Common& common, Scenery& scenery,
                    std::optional<int64_t> frame) {
  Loaded& in = scenery.load(a, common);
  const Job job = job_of(a, common);
  if (a.check) return {};
  const Vista& seen = scenery.vista(common);
  std::optional<GpuUpload> upload;
  if (scenery.device) upload.emplace(*scenery.device, seen, FilmPlanes{job.layers, job.halves});
  if (const std::string sentence = no_backs_sentence(seen); !sentence.empty())
    common.note(sentence);

  const std::string code = scenery.device ? kGpuCode : processor_code();
  const std::string mark =
      frame ? frame_mark(in.scene, in.portal_hashes, common, *frame) : std::string();
  const Fingerprint is_of =
      fingerprint_of(in.scene, in.portal_hashes, common, frame, cli::Effect::picture);
  const std::optional<Begun> begun = read_begun(a, is_of, seen);
  if (begun) check_explored(begun->plan.explored, in, seen, display_name(a.resume));
  const Explored explored =
      begun ? begun->plan.explored : explore(job, seen, in.camera, in.portals);
  const std::vector<Portal> drawn = in.portals;
  const Vista vista = explored_vista(explored, in, seen);
  const std::vector<Candidate> candidates = candidates_of(job, vista);
  const Integrator asked = job.automatic ? either_of(candidates) : job.named;
  if (begun) {
    if (!(begun->progress->film.options() == film_options(job, candidates)))
      throw InputError(display_name(a.resume), "film", "keeps other sums than this picture");
    tell_begun(*begun, a, code, common);
  }
  tell_before(job, vista, asked, drawn, explored.ways, common);

  const std::shared_ptr<SampleRenderer> renderer =
      upload ? upload->renderer(vista) : std::make_shared<CpuRenderer>(vista);
  if (scenery.device)
    common.note("samples are rendered by " + words_of(scenery.device->info()) + ".");
  Session session(*renderer, job);
  const Plan plan = begun ? begun->plan : make_plan(session, candidates, explored);
  if (plan.cut_short && !a.shard.empty()) {
    common.note("stopped by a signal before all was decided: no shard is written");
    return {static_cast<int>(Exit::interrupted), ""};
  }
  FilmFacts facts;
  facts.shape = is_of;
  facts.processor = begun ? merged_words(begun->processor, code) : code;
  facts.derived = derived_of(a);
  facts.attributes = begun ? begun->attributes : attributes_of(a, common, in, job, asked, plan);
  if (common.no_provenance) facts.attributes.erase(provenance_attribute);
  if (frame) facts.attributes[kFrameAttribute] = mark;
  Delivery files(a, common, std::move(facts));
  std::shared_ptr<Progress> progress = begun ? begun->progress : nullptr;
  if (!progress) {
    progress = std::make_shared<Progress>(new_progress(session, candidates, plan));
    take_part(a, *progress);
  }

  const RenderResult result = rendered(session, plan, std::move(progress), files);
  nlohmann::ordered_json stats = stats_of(job, asked, in.portals, result, renderer->name());
  if (frame) stats["frame"] = mark;
  // Among shards only the first has what samples do not change.
  const bool has_channels = result.progress->first == 0;
  const Delivery::Finish finish =
      files.deliver(result, has_channels ? channels_of(a, vista, job.seed) : Channels(),
                    [&](const Delivery::Finish& f) { return finished(stats, f).dump(); });
  tell_choice(session, result, common);
  if (!frame) tell_after(session, in.portals, result, a, common);
  if (!finish.filtered.empty()) common.note(finish.filtered);
  stats = finished(std::move(stats), finish);
  stats.erase("frames");
  common.summary(stats.dump());
  common.explain_by([&] {
    cli::Decisions all = uses_of(in.scene, all_needs());
    for (cli::Decision& d : decisions_of(stats)) all.push_back(std::move(d));
    return all;
  });
  const bool interrupted = result.progress->interrupted;
  return {static_cast<int>(interrupted ? Exit::interrupted : Exit::done), told_of(vista, result)};
}

}  // namespace tdpt
