#include "tools/tdpt-render/run/picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <new>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/tone.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/gpu/device_options.h"
#include "libcommon/scene/uses.h"
#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/integrators/features.h"
#include "tools/tdpt-render/run/options.h"
#include "tools/tdpt-render/run/progress.h"
#include "tools/tdpt-render/run/render.h"
#include "tools/tdpt-render/run/report.h"

namespace tdpt {

namespace {

// ---- The files of a picture: on the way checkpoints and previews, at the end all of them ----

// Value of kFrameAttribute for a frame that a signal interrupted.
constexpr const char* kIncomplete = "incomplete";

constexpr double kPreviewEvery = 5, kCheckpointEvery = 60;  // seconds

// Red where a pixel got some contribution, green where it is black.
std::string nonzero_png(const Picture& picture) {
  Picture marks{picture.width, picture.height, {}};
  marks.pixels.reserve(picture.pixels.size());
  for (const Rgb& p : picture.pixels)
    marks.pixels.push_back(p != Rgb{} ? Rgb{1, 0, 0} : Rgb{0, 1, 0});
  return png_bytes(marks);
}

// Where a picture is kept after a failed write.
std::string kept_sentence(const std::string& output, const std::string& bytes) {
  const std::string path = keep_elsewhere(output == "-" ? "picture.exr" : output, bytes);
  return path.empty() ? "the picture is lost" : "the picture is kept in " + path;
}

// The --aov channels that are computed from the film's sums, and the filter: FilmFacts::derived.
std::vector<std::string> derived_of(const RenderArguments& a) {
  std::vector<std::string> derived;
  for (const std::string& name : aovs_of(a))
    if (std::find(kDerived.begin(), kDerived.end(), name) != kDerived.end())
      derived.push_back(name);
  if (a.filters())
    derived.push_back(denoise::kDenoised[static_cast<size_t>(denoise::kind_of(a.denoiser))]);
  return derived;
}

// The --aov channels that samples do not change, and those that the filter needs.
Channels channels_of(const RenderArguments& a, const Vista& vista, uint64_t seed) {
  std::vector<std::string> names = aovs_of(a);
  if (a.filters()) names.insert(names.end(), {"albedo", "normal", "depth"});
  return features(vista, names, seed);
}

class Delivery {
 public:
  // `facts`: of the film, with the attributes that are known before it is rendered.
  Delivery(const RenderArguments& a, const cli::Common& common, FilmFacts facts)
      : a_(a), common_(common), facts_(std::move(facts)) {}

  // Where the checkpoint is kept; empty: nowhere.
  const std::string& checkpoint() const {
    return a_.checkpoint.empty() ? a_.resume : a_.checkpoint;
  }
  // Writes it. A failure is only a warning, since the previous one stays whole; returns false
  // then.
  bool save(const Plan& plan, Progress& progress, const Channels& channels = {}) const;
  // Between passes: renews checkpoint and preview where they are due, each for at most a tenth of
  // the time.
  void renew(const Plan& plan, Progress& progress);

  // Writes everything at the end. `channels`: those that samples do not change. `stats`: of
  // --stats; what became of the picture after its last sample is added. Returns what the filter
  // did, in a sentence; empty without one. Throws Error for what cannot be written, and says where
  // the picture is kept.
  std::string deliver(const RenderResult& result, const Channels& channels,
                      nlohmann::ordered_json& stats);

 private:
  void show(const Picture& picture) const;

  const RenderArguments& a_;
  const cli::Common& common_;
  FilmFacts facts_;
  std::array<double, 2> due_{};  // when checkpoint and preview are [s]; 0: not known
};

bool Delivery::save(const Plan& plan, Progress& progress, const Channels& channels) const {
  std::string why;
  try {
    write_output(checkpoint(), film_bytes(progress, plan, facts_, channels));
    return true;
  } catch (const OutputError& e) {
    why = e.what();
  } catch (const std::bad_alloc&) {
    why = checkpoint() + ": there is no memory for it";
  }
  std::error_code ignored;
  common_.warn(why + (std::filesystem::exists(checkpoint(), ignored)
                          ? "; the checkpoint before it is kept"
                          : "; there is no checkpoint yet"));
  return false;
}

void Delivery::renew(const Plan& plan, Progress& progress) {
  const auto each = [&](double& due, double every, const auto& work) {
    if (due == 0) due = progress.began + every;
    if (progress.seconds < due) return;
    const auto before = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    due = progress.seconds + std::max(every, 10 * took.count());
  };
  if (!checkpoint().empty())
    each(due_[0], a_.checkpoint_every < 0 ? kCheckpointEvery : a_.checkpoint_every,
         [&] { save(plan, progress); });
  if (!a_.preview.empty()) each(due_[1], kPreviewEvery, [&] { show(progress.film.picture()); });
}

// A failure is ignored: the final write will report it.
void Delivery::show(const Picture& picture) const {
  try {
    const std::optional<double> exposure = exposure_of(picture, a_.preview, a_.exposure);
    write_output(a_.preview, preview_bytes(picture, *exposure));
  } catch (const OutputError&) {
  }
}

std::string Delivery::deliver(const RenderResult& result, const Channels& channels,
                              nlohmann::ordered_json& stats) {
  if (result.target) facts_.attributes.merge(target_attributes(*result.target));
  if (result.progress->interrupted && facts_.attributes.contains(kFrameAttribute))
    facts_.attributes[kFrameAttribute] = kIncomplete;
  const bool saved = !checkpoint().empty() && !result.plan.cut_short &&
                     save(result.plan, *result.progress, channels);
  const Film& film = result.progress->film;
  const bool is_shard = !a_.shard.empty();
  ExrFile file{result.picture, {}, {}, {}, {}};
  std::optional<denoise::Filtered> filtered;
  const auto start = std::chrono::steady_clock::now();
  if (!is_shard) file = denoise::filtered_picture(film, facts_, channels, filtered);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  if (filtered && filtered->left)
    stats["filtered"] = {{"relmse", filtered->left->relmse},
                         {"interval", {filtered->left->low, filtered->left->high}}};
  const std::optional<double> exposure = exposure_of(file.picture, a_.preview, a_.exposure);
  if (exposure) stats["exposure"] = *exposure;
  const auto bytes = [&] {
    return is_shard ? film_bytes(*result.progress, result.plan, facts_, channels) : exr_bytes(file);
  };
  try {
    cli::deliver({{common_.output, bytes},
                  {a_.preview, [&] { return preview_bytes(file.picture, *exposure); }},
                  {a_.nonzero, [&] { return nonzero_png(result.picture); }},
                  {a_.stats, [&] { return stats.dump() + '\n'; }}},
                 common_);
  } catch (const OutputError& e) {
    throw Error(e.code, fmt::format("{}; {}", e.what(),
                                    saved ? fmt::format("all samples are in {}: --resume writes "
                                                        "the picture",
                                                        display_name(checkpoint()))
                                          : kept_sentence(common_.output, bytes())));
  }
  if (filtered) return fmt::format("{}; {:.1f} s", sentence_of(*filtered), took.count());
  return a_.filters() && !is_shard ? "not filtered: there is one sample per pixel" : "";
}

// ---- The picture ----

// Everything that determines a picture of the scene, or the `frame` of a shot. `portals`: hashes of
// its portal files.
Fingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& portals,
                           const cli::Common& common, std::optional<int64_t> frame,
                           cli::Effect up_to) {
  Fingerprint facts{{"scene", scene.hash},
                    {"environment", scene.sky_hash},
                    {"portal", fmt::format("{}", fmt::join(portals, " "))}};
  if (frame) facts.emplace_back("frame", std::to_string(*frame));
  return common.fingerprint(facts, up_to);
}

// Portals work in the ways that light passes them, and kinds of light are selected by what arrives.
Vista explored_vista(const Explored& explored, LoadedScene& in, Vista vista) {
  if (explored.ways.empty() && explored.lights == vista.openings.selection.shares()) return vista;
  apply_ways(explored.ways, in.portals);
  vista.openings = Openings(*vista.world, in.portals, explored.lights, vista.openings.windows);
  return vista;
}

// Those of a new picture, which a resumed one keeps.
std::map<std::string, std::string> attributes_of(const RenderArguments& a,
                                                 const cli::Common& common, const LoadedScene& in,
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

// If the device is lost, what has been rendered is kept where a checkpoint can hold it.
RenderResult rendered(Session& session, const Plan& plan, const std::shared_ptr<Progress>& progress,
                      Delivery& files) {
  try {
    return render(session, plan, progress, [&] { files.renew(plan, *progress); });
  } catch (const Error& e) {
    if (files.checkpoint().empty() || plan.cut_short || progress->film.samples() == 0 ||
        !files.save(plan, *progress))
      throw;
    throw Error(e.code, fmt::format("{}; what was rendered is in {}: --resume goes on from it",
                                    e.what(), display_name(files.checkpoint())));
  }
}

void note_resumed(const Begun& begun, const RenderArguments& a, const std::string& code,
                  const cli::Common& common) {
  if (begun.facts.processor != code)
    common.warn(other_code_sentence(display_name(a.resume), begun.facts.processor, code));
  const uint64_t done = begun.progress->film.samples();
  common.note(fmt::format("goes on from {}, which has {} of {} samples per pixel",
                          display_name(a.resume), done, std::max(begun.progress->goal, done)));
}

// The film's facts beside plan and progress; those of a picture that is resumed stay.
FilmFacts facts_of(const RenderArguments& a, const cli::Common& common, const LoadedScene& in,
                   const Session& session, const Integrator& asked, const Plan& plan,
                   const std::optional<Begun>& begun, const std::string& code) {
  FilmFacts facts;
  facts.processor = begun ? merged_words(begun->facts.processor, code) : code;
  facts.derived = derived_of(a);
  facts.attributes =
      begun ? begun->facts.attributes : attributes_of(a, common, in, session.job, asked, plan);
  if (common.no_provenance) facts.attributes.erase(provenance_attribute);
  return facts;
}

// Writes the files of a rendered picture, and reports it. `mark`: of a frame of a shot; else empty.
void finish(const RenderArguments& a, const cli::Common& common, const LoadedScene& in,
            const Session& session, const Integrator& asked, const RenderResult& result,
            const std::string& mark, Delivery& files) {
  nlohmann::ordered_json stats =
      stats_of(session.job, asked, in.portals, result, session.renderer.name());
  if (!mark.empty()) stats["frame"] = mark;
  // Among shards only the first has what samples do not change.
  const Channels channels =
      result.progress->first == 0 ? channels_of(a, session.vista, session.job.seed) : Channels();
  const std::string filtered = files.deliver(result, channels, stats);
  report_choice(session, result, common);
  if (mark.empty()) report_after(session, in.portals, result, a, common);
  if (!filtered.empty()) common.note(filtered);
  stats.erase("frames");
  common.summary(stats.dump());
  common.explain_by([&] {
    cli::Decisions all = uses_of(in.scene, all_needs());
    for (cli::Decision& d : decisions_of(stats)) all.push_back(std::move(d));
    return all;
  });
}

}  // namespace

std::string frame_mark(const Scene& scene, const std::vector<std::string>& portals,
                       const cli::Common& common, int64_t frame) {
  return fmt::format("{} {}", frame,
                     hash_of(fingerprint_of(scene, portals, common, frame, cli::Effect::stored)));
}

Outcome render_picture(const RenderArguments& a, const cli::Common& common, SceneCache& scenes,
                       std::optional<int64_t> frame) {
  LoadedScene& in = scenes.load(a, common);
  const Job job = job_of(a, common);
  if (a.check) return {};
  const Vista& seen = scenes.vista(a, common);
  std::optional<GpuUpload> upload;
  if (scenes.device) upload.emplace(*scenes.device, seen, FilmPlanes{job.layers, job.halves});

  const std::string code = scenes.device ? kGpuCode : processor_code();
  const std::string mark =
      frame ? frame_mark(in.scene, in.portal_hashes, common, *frame) : std::string();
  const Fingerprint is_of =
      fingerprint_of(in.scene, in.portal_hashes, common, frame, cli::Effect::picture);
  const std::optional<Begun> begun = read_begun(a, is_of, seen);
  const Explored explored =
      explore(job, seen, in.camera, in.portals, begun ? explored_in(begun->facts.plan) : 0);
  const std::vector<Portal> drawn = in.portals;
  const Vista vista = explored_vista(explored, in, seen);
  const std::vector<Candidate> candidates = candidates_of(job, vista);
  const Integrator asked = job.automatic ? either_of(candidates) : job.named;
  if (begun) {
    if (!(begun->progress->film.options() == film_options(job, candidates)))
      throw InputError(display_name(a.resume), "film", "keeps other sums than this picture");
    note_resumed(*begun, a, code, common);
  }
  report_before(job, vista, asked, drawn, explored.ways, common);

  const std::shared_ptr<SampleRenderer> renderer =
      upload ? upload->renderer(vista) : std::make_shared<CpuRenderer>(vista);
  if (scenes.device)
    common.note("samples are rendered by " + words_of(scenes.device->info()) + ".");
  Session session(*renderer, job);
  const Plan plan =
      make_plan(session, candidates, explored, begun ? label_in(begun->facts.plan) : "");
  if (begun && plan_words(plan) != begun->facts.plan)
    throw InputError(display_name(a.resume), "film.plan",
                     "was made otherwise by code for " + shown(begun->facts.processor));
  if (plan.cut_short && !a.shard.empty()) {
    common.note("stopped by a signal before all was decided: no shard is written");
    return {static_cast<int>(Exit::interrupted), ""};
  }
  FilmFacts facts = facts_of(a, common, in, session, asked, plan, begun, code);
  facts.shape = is_of;
  if (frame) facts.attributes[kFrameAttribute] = mark;
  Delivery files(a, common, std::move(facts));
  std::shared_ptr<Progress> progress = begun ? begun->progress : nullptr;
  if (!progress) {
    progress = std::make_shared<Progress>(new_progress(session, candidates, plan));
    take_part(a, *progress);
  }
  const RenderResult result = rendered(session, plan, progress, files);
  finish(a, common, in, session, asked, result, mark, files);
  const bool interrupted = result.progress->interrupted;
  return {static_cast<int>(interrupted ? Exit::interrupted : Exit::done),
          outcome_words(vista, result)};
}

}  // namespace tdpt
