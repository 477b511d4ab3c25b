#include "tools/tdpt-render/run/shot.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/signals.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/tone.h"
#include "tools/tdpt-render/run/delivery.h"

namespace tdpt {
namespace {

constexpr int64_t kFramesPerPlan = 12;  // at most, from key to key

// The option of a file and its path.
struct FileOption {
  const char* option;
  std::string* path;
};

std::array<FileOption, 5> files_beside(Arguments& a) {
  return {{{"--preview", &a.preview},
           {"--checkpoint", &a.checkpoint},
           {"--resume", &a.resume},
           {"--stats", &a.stats},
           {"--set nonzero", &a.nonzero}}};
}

// Whether frames are filtered with those beside them.
bool filters_together(const Arguments& a) {
  return a.filters() && a.denoiser != kDenoisers.back() && a.shard.empty();
}

// Job::mark: the number of the frame, and a hash of what determines its picture. `shape`: of its
// film. `content`: the plan that it obeys, where --plan names one, and the frames with which it is
// filtered.
std::string frame_mark(const Arguments& a, const cli::Common& common, const Shape& shape,
                       const std::string& content) {
  const auto facts = std::make_tuple(
      a.spp, a.seconds, a.target_error, a.retry, static_cast<int>(common.quality), a.denoise,
      a.denoiser, a.since, a.aov, a.pixels, a.compression, common.no_provenance, content);
  std::string text = fmt::format("{}|", fmt::join(facts, "|"));
  for (const auto& [name, value] : shape) text += name + "=" + value + "|";
  return fmt::format("{} {}", *a.frame, content_hash(text));
}

// Whether the file is whole and has this mark. `shard`: of --shard; then it must be a film of that
// part.
bool has_mark(const std::string& path, const std::string& mark, const std::string& shard) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return false;
  try {
    const std::string bytes = read_file(path);
    const ExrFile file = parse_exr(bytes, path);
    const auto at = file.attributes.find(kFrameAttribute);
    if (at == file.attributes.end() || at->second != mark) return false;
    if (shard.empty()) return !is_film(file);
    if (!is_film(file)) return false;
    const FilmFile film = parse_film(bytes, path);
    const SampleRange part = shard_of(shard).part(0, film.facts.spp);
    const std::vector<SampleRange> there = film.film.ranges();
    return there.size() == 1 && there[0].first == part.first && there[0].count == part.count;
  } catch (const InputError&) {
    return false;  // damaged: it is rendered again
  }
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

void check_frames(const Arguments& a, const cli::Common& common) {
  const FrameRange range = frame_range(a.shot);
  if (a.accumulate && !a.shard.empty())
    throw UsageError("--accumulate: is for whole frames, not for --shard");
  if (a.camera.frame) throw UsageError("--frame: is for one picture, --frames for a shot");
  if (a.scene == "-") throw UsageError("--frames: reads the scene more than once, not from -");
  if (!common.dependencies.empty())
    throw UsageError("--set dependencies: is for one picture, --frames for a shot");
  if (a.add_samples > 0) throw UsageError("--add-samples: is for one picture, --frames for a shot");
  if (only_plans(a, common.output_given)) {
    if (!a.stats.empty() || common.json)
      throw UsageError("--stats and --json: are of the frames of a shot, and need -o");
  } else {
    if (!common.output_given || common.output == "-")
      throw UsageError("--frames: needs -o, a name such as shot.####.exr");
    frame_run(a, common, range.first, range.first);  // throws for names without a number
  }
}

FrameRun frame_run(const Arguments& a, const cli::Common& common, int64_t frame, int64_t since) {
  FrameRun run{a, common};
  run.arguments.frame = frame;
  run.arguments.since = since;
  run.arguments.pose.seconds = static_cast<double>(frame) / a.shot.fps;
  for (std::string& path : run.arguments.portals) {
    if (!has_frame_number(path)) continue;
    path = name_of_frame("--portal", path, frame);
    run.arguments.portals_by_frame = true;
  }
  run.common.seed = common.seed + static_cast<uint64_t>(since);
  run.common.give("--frames", {words_of(FrameRange{since, frame})});
  if (only_plans(a, common.output_given)) return run;
  run.common.output = name_of_frame("-o", common.output, frame);
  run.common.outputs = {{"-o", run.common.output}};
  for (const auto& [option, path] : files_beside(run.arguments)) {
    if (path->empty()) continue;
    *path = name_of_frame(option, *path, frame);
    run.common.outputs.push_back({option, *path});
  }
  return run;
}

namespace {

// What may be decided at a key frame. `shape`: of the shot.
KeyFrame decided_key(const Arguments& a, const cli::Common& common, Workshop& shop, int64_t frame,
                     Shape& shape) {
  FrameRun run = frame_run(a, common, frame, frame);
  for (std::string* path : {&run.arguments.checkpoint, &run.arguments.resume, &run.arguments.shard,
                            &run.arguments.plan})
    path->clear();
  DecidedFrame decided = decide_frame(run.arguments, run.common, shop);
  if (stop_requested()) throw Error(Exit::interrupted, "stopped by a signal; no plan is made");
  shape = decided.shape;
  return std::move(decided.key);
}

PlanFile plan_of_shot(const Arguments& a, const cli::Common& common, Workshop& shop) {
  PlanFile shot;
  const FrameRange range = frame_range(a.shot);
  std::vector<KeyFrame> keys;
  for (const int64_t frame : key_frames(range, kFramesPerPlan))
    keys.push_back(decided_key(a, common, shop, frame, shot.shape));
  while (const auto between = next_key(keys)) {
    const auto after = std::find_if(keys.begin(), keys.end(),
                                    [&](const KeyFrame& k) { return k.frame > *between; });
    keys.insert(after, decided_key(a, common, shop, *between, shot.shape));
  }
  shot.frames = even_plans(keys);
  shot.command = common.command;
  common.note(plan_sentence(shot, range.first, range.last));
  return shot;
}

// A frame of a shot.
struct Frame {
  int64_t since;                     // the first whose samples it has [frame_run()]
  std::vector<std::string> portals;  // hashes of files of its own
  std::vector<int64_t> beside;       // the frames with which it is filtered
  std::string mark;
  bool missing = true;  // not there, complete and by this command
};
using Frames = std::map<int64_t, Frame>;

// All of them: with --accumulate those in which nothing has moved share their first one.
Frames planned_frames(const Arguments& a, const cli::Common& common, Workshop& shop) {
  Frames frames;
  const FrameRange range = frame_range(a.shot);
  std::string before;
  for (int64_t k = range.first, since = k; k <= range.last; ++k) {
    const Arguments alone = frame_run(a, common, k, k).arguments;
    std::vector<std::string> portals;
    if (alone.portals_by_frame)
      for (const std::string& path : alone.portals) portals.push_back(read_portals(path).hash);
    std::string moment =
        a.accumulate ? fmt::format("{} {}", shop.scenery.moment(alone), fmt::join(portals, " "))
                     : "";
    if (!a.accumulate || moment != before) since = k;
    before = std::move(moment);
    frames.emplace(k, Frame{since, std::move(portals), {}, {}});
  }
  return frames;
}

// Frames beside this one whose samples are not its own.
std::vector<int64_t> frames_beside(int64_t frame, const Frames& frames) {
  std::vector<int64_t> beside;
  for (const int64_t k : {frame - 1, frame + 1}) {
    const auto other = frames.find(k);
    if (other != frames.end() && other->second.since != frames.at(frame).since) beside.push_back(k);
  }
  return beside;
}

Frames frames_of(const Arguments& a, const cli::Common& common, Workshop& shop,
                 const PlanFile* plan) {
  const int64_t first = frame_range(a.shot).first;
  const FrameRun run = frame_run(a, common, first, first);
  const Loaded& in = shop.scenery.load(run.arguments, run.common);
  Frames frames = planned_frames(a, common, shop);
  size_t there = 0;
  for (auto& [k, frame] : frames) {
    const FrameRun own = frame_run(a, common, k, frame.since);
    Shaping by = shaping_of(in, own.arguments, own.common);
    if (own.arguments.portals_by_frame) by.portal_hashes = frame.portals;
    if (filters_together(a)) frame.beside = frames_beside(k, frames);
    std::string content = plan ? plan_text(plan->of_frame(frame.since)) : "";
    for (const int64_t other : frame.beside)
      content += fmt::format(" {} since {}", other, frames.at(other).since);
    frame.mark = frame_mark(own.arguments, common, film_shape_of(own.arguments, by), content);
    frame.missing = !has_mark(own.common.output, frame.mark, a.shard);
    there += !frame.missing;
    if (frame.missing) check_schedule(own.arguments);
  }
  if (there > 0)
    common.note(fmt::format("{} there already",
                            there == 1 ? "1 frame is" : fmt::format("{} frames are", there)));
  return frames;
}

// Previews of one exposure, so that they do not flicker: that of the first frame that is there.
class Previews {
 public:
  Previews(const Arguments& a, const cli::Common& common) : a_(a), common_(common) {}

  /// A frame is complete.
  void take(const FrameRun& run) {
    if (a_.preview.empty() || exposure()) return;
    exposure_ = auto_exposure(read_exr(run.common.output).picture);
    common_.note(fmt::format("previews are exposed as frame {}: --exposure {}",
                             *run.arguments.frame, number_words(*exposure_)));
  }
  /// Writes that of a complete frame if it is not there, or is not as it should be now.
  void mend(const FrameRun& run) const {
    const std::string& path = run.arguments.preview;
    if (path.empty()) return;
    const std::string bytes =
        preview_bytes(read_exr(run.common.output).picture, exposure().value_or(0));
    std::error_code failed;
    if (!std::filesystem::exists(path, failed) || read_file(path) != bytes)
      write_output(path, bytes);
  }
  /// Nothing while no frame is there.
  std::optional<double> exposure() const { return a_.exposure ? a_.exposure : exposure_; }

 private:
  const Arguments& a_;
  const cli::Common& common_;
  std::optional<double> exposure_;
};

// The frames of a shot that are filtered together with those beside them.
class FilteredFrames {
 public:
  FilteredFrames(const Arguments& a, const cli::Common& common, Workshop& shop,
                 const PlanFile& plan, const Frames& frames)
      : a_(a), common_(common), shop_(shop), plan_(plan), frames_(frames) {}

  /// Renders what the frame needs and is not rendered yet, filters it and writes it.
  Made make(const FrameRun& run) {
    const int64_t number = *run.arguments.frame;
    std::vector<int64_t> needed = frames_.at(number).beside;
    needed.push_back(number);
    std::sort(needed.begin(), needed.end());
    for (const int64_t k : needed) {
      if (noisy_.contains(k)) continue;
      const Frame& other = frames_.at(k);
      FrameRun noisy = frame_run(a_, common_, k, other.since);
      if (!other.missing) keep_files_of(noisy);
      MadeNoisy made = render_noisy(noisy.arguments, noisy.common, shop_, &plan_, other.mark);
      if (made.code != 0) return made;
      noisy_[k] = std::move(made);
    }
    noisy_.erase(noisy_.begin(), noisy_.lower_bound(number - 1));
    std::vector<denoise::NamedPicture> beside;
    for (const int64_t k : frames_.at(number).beside)
      if (const Unfiltered& other = noisy_.at(k).picture; other.both_halves)
        beside.push_back({other.file, fmt::format("{}", k)});
    Unfiltered picture = noisy_.at(number).picture;
    const Delivered delivered =
        deliver_frame(run.arguments, run.common, std::move(picture), beside);
    const std::string filtered =
        delivered.left ? "; filtered: " + denoise::words_of(delivered.left) : std::string();
    return {0, noisy_.at(number).words + filtered};
  }

 private:
  // Of a frame that is there, and rendered again only for those beside it.
  static void keep_files_of(FrameRun& run) {
    for (const auto& [option, path] : files_beside(run.arguments)) path->clear();
    run.common.json = false;
  }

  const Arguments& a_;
  const cli::Common& common_;
  Workshop& shop_;
  const PlanFile& plan_;
  const Frames& frames_;
  std::map<int64_t, MadeNoisy> noisy_;  // those rendered last
};

}  // namespace

int render_shot(const Arguments& a, const cli::Common& common, Workshop& shop) {
  if (a.check) {
    const int64_t k = frame_range(a.shot).first;
    const FrameRun first = frame_run(a, common, k, k);
    return render_picture(first.arguments, first.common, shop, nullptr).code;
  }
  std::optional<PlanFile> plan;
  if (obeys_plan(a, common.output_given)) {
    plan = read_plan_file(a.plan);
    if (plan->frames.empty())
      throw InputError(display_name(a.plan), "",
                       "is the plan of a picture, expected one of a shot");
  } else if (!a.plan.empty()) {
    plan = plan_of_shot(a, common, shop);
    write_output(a.plan, plan_file_text(*plan));
    if (only_plans(a, common.output_given)) return 0;
  }
  const Frames frames = frames_of(a, common, shop, plan ? &*plan : nullptr);
  const auto missing = static_cast<size_t>(
      std::count_if(frames.begin(), frames.end(), [](const auto& f) { return f.second.missing; }));
  if (missing > 0 && !plan) plan = plan_of_shot(a, common, shop);
  Previews previews(a, common);
  for (const auto& [k, frame] : frames) {
    if (frame.missing) continue;
    const FrameRun run = frame_run(a, common, k, frame.since);
    previews.take(run);
    previews.mend(run);
  }
  const auto start = std::chrono::steady_clock::now();
  size_t done = 0;
  std::optional<FilteredFrames> filtered;
  if (plan && filters_together(a)) filtered.emplace(a, common, shop, *plan, frames);
  for (const auto& [k, frame] : frames) {
    if (!frame.missing) continue;
    FrameRun run = frame_run(a, common, k, frame.since);
    run.arguments.exposure = previews.exposure();
    const Made made = filtered
                          ? filtered->make(run)
                          : render_picture(run.arguments, run.common, shop, &*plan, frame.mark);
    if (made.code != 0) return made.code;
    previews.take(run);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    common.note(fmt::format("frame {}: {}; {}", k, made.words,
                            progress_words(++done, missing, took.count())));
  }
  return 0;
}

}  // namespace tdpt
