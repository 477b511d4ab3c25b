#include "tools/tdpt-render/run/shot.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/signals.h"
#include "libcommon/formats/picture.h"
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

// Job::mark: the number of the frame, and a hash of what determines its picture. `shape`: of its
// film. `plan`: text of the plan that it obeys, where --plan names one.
std::string frame_mark(const Arguments& a, const Shape& shape, int quality,
                       const std::string& plan) {
  std::string text =
      fmt::format("{} {} {} {}|{} {} {}|{} {}|{}|{}|", a.spp, a.seconds, a.target_error, a.retry,
                  a.denoise, a.denoiser, a.aov, a.pixels, a.compression, quality, plan);
  for (const auto& [name, value] : shape) text += name + "=" + value + "|";
  return fmt::format("{} {}", a.frame.value_or(0), content_hash(text));
}

// Whether the file is whole and has this mark.
bool has_mark(const std::string& path, const std::string& mark) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return false;
  try {
    const ExrFile file = read_exr(path);
    const auto at = file.attributes.find(kFrameAttribute);
    return at != file.attributes.end() && at->second == mark;
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
  if (a.camera.frame) throw UsageError("--frame: is for one picture, --frames for a shot");
  if (a.scene == "-") throw UsageError("--frames: reads the scene more than once, not from -");
  if (!common.dependencies.empty())
    throw UsageError("--set dependencies: is for one picture, --frames for a shot");
  if (a.add_samples > 0) throw UsageError("--add-samples: is for one picture, --frames for a shot");
  if (!only_plans(a, common.output_given)) {
    if (!common.output_given || common.output == "-")
      throw UsageError("--frames: needs -o, a name such as shot.####.exr");
    frame_run(a, common, range.first);  // throws for names without a number
  }
}

FrameRun frame_run(const Arguments& a, const cli::Common& common, int64_t frame) {
  FrameRun run{a, common};
  run.arguments.frame = frame;
  run.arguments.pose.seconds = static_cast<double>(frame) / a.shot.fps;
  for (std::string& path : run.arguments.portals) {
    if (!has_frame_number(path)) continue;
    path = name_of_frame("--portal", path, frame);
    run.arguments.portals_by_frame = true;
  }
  run.common.seed = common.seed + static_cast<uint64_t>(frame);
  run.common.command = command_of_frame(common.command, frame);
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
  FrameRun run = frame_run(a, common, frame);
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

// The frames that are missing, not complete, or of another command, with their marks.
std::map<int64_t, std::string> frames_to_do(const Arguments& a, const cli::Common& common,
                                            Workshop& shop, const PlanFile* plan) {
  std::map<int64_t, std::string> marks;
  const FrameRange range = frame_range(a.shot);
  const FrameRun first = frame_run(a, common, range.first);
  const Loaded& in = shop.scenery.load(first.arguments, first.common);
  for (int64_t k = range.first; k <= range.last; ++k) {
    const FrameRun run = frame_run(a, common, k);
    Shaping by = shaping_of(in, run.arguments, run.common);
    if (run.arguments.portals_by_frame) {
      by.portal_hashes.clear();
      for (const std::string& path : run.arguments.portals)
        by.portal_hashes.push_back(content_hash_of_file(path));
    }
    const Shape shape = film_shape_of(run.arguments, by);
    const std::string mark = frame_mark(run.arguments, shape, static_cast<int>(common.quality),
                                        plan ? plan_text(plan->of_frame(k)) : "");
    if (!has_mark(run.common.output, mark)) marks[k] = mark;
  }
  if (const auto there = static_cast<size_t>(range.count()) - marks.size(); there > 0)
    common.note(fmt::format("{} there already",
                            there == 1 ? "1 frame is" : fmt::format("{} frames are", there)));
  return marks;
}

// That of the previews, so that they do not flicker: what suits the first frame that is there;
// nothing while none is.
std::optional<double> exposure_of_shot(const cli::Common& common) {
  const std::optional<int64_t> first = first_frame_there(common.output);
  if (!first) return {};
  try {
    const double exposure =
        auto_exposure(read_exr(name_of_frame("-o", common.output, *first)).picture);
    common.note(fmt::format("previews are exposed as frame {}: --exposure {}", *first,
                            number_words(exposure)));
    return exposure;
  } catch (const InputError&) {
    return {};
  }
}

// The frames of a shot that are filtered together with those before and after them.
class FilteredFrames {
 public:
  FilteredFrames(const Arguments& a, const cli::Common& common, Workshop& shop,
                 const PlanFile& plan)
      : a_(a), common_(common), shop_(shop), plan_(plan), range_(frame_range(a.shot)) {}

  /// Renders what the frame needs and is not rendered yet, filters it and writes it.
  Made make(const FrameRun& run, const std::string& mark) {
    const int64_t frame = *run.arguments.frame;
    for (int64_t k = frame - 1; k <= frame + 1; ++k) {
      if (k < range_.first || k > range_.last || noisy_.contains(k)) continue;
      const FrameRun other = frame_run(a_, common_, k);
      MadeNoisy made = render_noisy(other.arguments, other.common, shop_, &plan_, "");
      if (made.code != 0) return made;
      noisy_[k] = std::move(made);
    }
    noisy_.erase(noisy_.begin(), noisy_.lower_bound(frame - 1));
    std::vector<denoise::NamedPicture> frames;
    for (const auto& [k, made] : noisy_)
      if (std::abs(k - frame) == 1 && made.picture.both_halves)
        frames.push_back({made.picture.file, fmt::format("{}", k)});
    Unfiltered picture = noisy_.at(frame).picture;
    picture.file.attributes[kFrameAttribute] = mark;
    const Delivered delivered =
        deliver_frame(run.arguments, run.common, std::move(picture), frames);
    const std::string filtered =
        delivered.relmse > 0
            ? fmt::format("; filtered: relMSE about {}", number_words(delivered.relmse, 2))
            : std::string();
    return {0, noisy_.at(frame).words + filtered};
  }

 private:
  const Arguments& a_;
  const cli::Common& common_;
  Workshop& shop_;
  const PlanFile& plan_;
  FrameRange range_;
  std::map<int64_t, MadeNoisy> noisy_;  // those rendered last
};

}  // namespace

int render_shot(const Arguments& a, const cli::Common& common, Workshop& shop) {
  if (a.check) {
    const FrameRun first = frame_run(a, common, frame_range(a.shot).first);
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
  const auto todo = frames_to_do(a, common, shop, plan ? &*plan : nullptr);
  if (!todo.empty() && !plan) plan = plan_of_shot(a, common, shop);
  const auto start = std::chrono::steady_clock::now();
  size_t done = 0;
  std::optional<FilteredFrames> filtered;
  std::optional<double> exposure;
  if (!todo.empty() && a.filters() && a.denoiser != kDenoisers[1] && a.shard.empty())
    filtered.emplace(a, common, shop, *plan);
  for (const auto& [frame, mark] : todo) {
    FrameRun run = frame_run(a, common, frame);
    if (!a.preview.empty() && !a.exposure) {
      if (!exposure) exposure = exposure_of_shot(common);
      run.arguments.exposure = exposure;
    }
    const Made made = filtered ? filtered->make(run, mark)
                               : render_picture(run.arguments, run.common, shop, &*plan, mark);
    if (made.code != 0) return made.code;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    common.note(fmt::format("frame {}: {}; {}", frame, made.words,
                            progress_words(++done, todo.size(), took.count())));
  }
  return 0;
}

}  // namespace tdpt
