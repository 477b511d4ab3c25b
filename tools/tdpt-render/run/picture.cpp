#include "tools/tdpt-render/run/picture.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/tone.h"
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

// Value of kFrameAttribute for a complete frame: its number and a hash of all that determines it.
std::string frame_mark(const Scene& scene, const std::vector<std::string>& portals,
                       const cli::Common& common, int64_t frame) {
  return fmt::format("{} {}", frame,
                     hash_of(fingerprint_of(scene, portals, common, frame, cli::Effect::stored)));
}

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
  if (begun.processor != code)
    common.warn(other_code_sentence(display_name(a.resume), begun.processor, code));
  const uint64_t done = begun.progress->film.samples();
  common.note(fmt::format("goes on from {}, which has {} of {} samples per pixel",
                          display_name(a.resume), done, std::max(begun.progress->goal, done)));
}

// The film's facts beside plan and progress; those of a picture that is resumed stay.
FilmFacts facts_of(const RenderArguments& a, const cli::Common& common, const Loaded& in,
                   const Session& session, const Integrator& asked, const Plan& plan,
                   const std::optional<Begun>& begun, const std::string& code) {
  FilmFacts facts;
  facts.processor = begun ? merged_words(begun->processor, code) : code;
  facts.derived = derived_of(a);
  facts.attributes =
      begun ? begun->attributes : attributes_of(a, common, in, session.job, asked, plan);
  if (common.no_provenance) facts.attributes.erase(provenance_attribute);
  return facts;
}

// Writes the files of a rendered picture, and reports it. `mark`: of a frame of a shot; else empty.
void finish(const RenderArguments& a, const cli::Common& common, const Loaded& in,
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

Outcome render_picture(const RenderArguments& a, const cli::Common& common, Scenery& scenery,
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
    note_resumed(*begun, a, code, common);
  }
  report_before(job, vista, asked, drawn, explored.ways, common);

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

namespace {

// What the command line would say of one frame alone.
struct FrameCommand {
  int64_t number;
  RenderArguments a;
  cli::Common common;
};

FrameCommand frame_command(const RenderArguments& a, const cli::Common& common, int64_t frame) {
  FrameCommand one{frame, a, common};
  one.a.pose.seconds = static_cast<double>(frame) / a.shot.fps;
  for (std::string& path : one.a.portals)
    if (has_frame_number(path)) path = name_of_frame("--portal", path, frame);
  one.common.seed = common.seed + static_cast<uint64_t>(frame);
  one.common.give("--frames", {std::to_string(frame)});
  one.common.outputs.clear();
  const auto name = [&](const char* option, std::string& path) {
    if (path.empty()) return;
    path = name_of_frame(option, path, frame);
    one.common.outputs.push_back({option, path});
  };
  name("-o", one.common.output);
  name("--preview", one.a.preview);
  name("--checkpoint", one.a.checkpoint);
  name("--resume", one.a.resume);
  name("--stats", one.a.stats);
  name("--set nonzero", one.a.nonzero);
  return one;
}

// Whether the file is this frame, complete, as its header says: files are written whole or not at
// all.
bool is_made(const FrameCommand& frame, const std::string& mark) {
  const auto attributes = string_attributes_of_file(frame.common.output);
  const auto is = [&](const char* name, const std::string& value) {
    const auto at = attributes.find(name);
    return at != attributes.end() && at->second == value;
  };
  if (!is(kFrameAttribute, mark)) return false;
  if (frame.a.shard.empty()) return !attributes.contains(film_attribute);
  const auto spp = static_cast<uint64_t>(frame.a.spp);
  return is(kPartAttribute, part_words({samples_of_shard(frame.a.shard, spp)}, spp));
}

// Writes the preview of a complete frame if it is not there, or is not as it should be now.
void mend_preview(const FrameCommand& frame) {
  const std::string& path = frame.a.preview;
  const Picture picture = read_exr(frame.common.output).picture;
  const std::string bytes = preview_bytes(picture, *frame.a.exposure);
  std::error_code failed;
  if (!std::filesystem::exists(path, failed) || read_file(path) != bytes) write_output(path, bytes);
}

// Hashes of the portal files of a frame; those that all frames share are read already.
std::vector<std::string> portals_of(const FrameCommand& frame, const RenderArguments& shot,
                                    const Loaded& in) {
  std::vector<std::string> hashes = in.portal_hashes;
  for (size_t i = 0; i < hashes.size(); ++i)
    if (has_frame_number(shot.portals[i])) hashes[i] = read_portals(frame.a.portals[i]).hash;
  return hashes;
}

// "3 of 10 done, about 5 min left".
std::string progress_words(size_t done, size_t of, double seconds) {
  std::string text = fmt::format("{} of {} done", done, of);
  if (done < of)
    text += fmt::format(", about {} left", duration_words(seconds / static_cast<double>(done) *
                                                          static_cast<double>(of - done)));
  return text;
}

}  // namespace

void check_frames(const RenderArguments& a, const cli::Common& common) {
  if (a.camera.frame) throw UsageError("--frame: is for one picture, --frames for a shot");
  if (a.scene == "-") throw UsageError("--frames: reads the scene more than once, not from -");
  if (!common.dependencies.empty())
    throw UsageError("--set dependencies: is for one picture, --frames for a shot");
  if (a.add_samples > 0) throw UsageError("--add-samples: is for one picture, --frames for a shot");
  if (!common.output_given || common.output == "-")
    throw UsageError("--frames: needs -o, a name such as shot.####.exr");
  frame_command(a, common, frame_range(a.shot).first);  // throws for names without a number
}

int render_shot(const RenderArguments& a, const cli::Common& common, Scenery& scenery) {
  const FrameRange range = frame_range(a.shot);
  const FrameCommand first = frame_command(a, common, range.first);
  const Loaded& in = scenery.load(first.a, first.common);
  if (a.check) return 0;
  std::vector<int64_t> there, missing;
  for (int64_t k = range.first; k <= range.last; ++k) {
    const FrameCommand frame = frame_command(a, common, k);
    const std::string mark = frame_mark(in.scene, portals_of(frame, a, in), frame.common, k);
    (is_made(frame, mark) ? there : missing).push_back(k);
  }
  if (!there.empty())
    common.note(there.size() == 1 ? "1 frame is there already"
                                  : fmt::format("{} frames are there already", there.size()));
  std::optional<double> exposure = a.exposure;  // of all previews, so that they do not flicker
  const auto expose = [&](const FrameCommand& frame) {
    if (a.preview.empty() || exposure) return;
    exposure = auto_exposure(read_exr(frame.common.output).picture);
    common.note(fmt::format("previews are exposed as frame {}: --exposure {}", frame.number,
                            number_words(*exposure)));
  };
  for (const int64_t k : there) {
    if (a.preview.empty()) break;
    FrameCommand frame = frame_command(a, common, k);
    expose(frame);
    frame.a.exposure = exposure;
    mend_preview(frame);
  }
  const auto start = std::chrono::steady_clock::now();
  for (size_t done = 0; done < missing.size(); ++done) {
    FrameCommand frame = frame_command(a, common, missing[done]);
    frame.a.exposure = exposure;
    frame.common.quiet = common.quiet || done > 0;  // the first tells what all have
    check_checkpoint(frame.a);
    const Outcome made = render_picture(frame.a, frame.common, scenery, frame.number);
    if (made.code != 0) return made.code;
    expose(frame);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    common.note(fmt::format("frame {}: {}; {}", frame.number, made.words,
                            progress_words(done + 1, missing.size(), took.count())));
  }
  return 0;
}

}  // namespace tdpt
