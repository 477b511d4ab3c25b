#include "tools/tdpt-render/run/shot.h"

#include <chrono>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/words.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/tone.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt {
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
  if (path.empty()) return;
  const Picture picture = read_exr(frame.common.output).picture;
  const std::string bytes =
      preview_bytes(picture, frame.a.exposure.value_or(auto_exposure(picture)));
  std::error_code failed;
  if (!std::filesystem::exists(path, failed) || read_file(path) != bytes) write_output(path, bytes);
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
  const auto start = std::chrono::steady_clock::now();
  size_t done = 0, there = 0;
  std::optional<double> exposure = a.exposure;  // of all previews, so that they do not flicker
  for (int64_t k = range.first; k <= range.last; ++k) {
    FrameCommand frame = frame_command(a, common, k);
    frame.a.exposure = exposure;
    frame.common.quiet = common.quiet || done > 0;  // the first tells what all have
    const Loaded& in = scenery.load(frame.a, frame.common);
    if (a.check) return 0;
    if (is_made(frame, frame_mark(in, frame.common, k))) {
      ++there;
      mend_preview(frame);
    } else {
      check_checkpoint(frame.a);
      const Made made = render_picture(frame.a, frame.common, scenery, k);
      if (made.code != 0) return made.code;
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      const size_t left = static_cast<size_t>(range.count()) - there;
      common.note(fmt::format("frame {}: {}; {}", k, made.words,
                              progress_words(++done, left, took.count())));
    }
    if (!a.preview.empty() && !exposure) {
      exposure = auto_exposure(read_exr(frame.common.output).picture);
      common.note(fmt::format("previews are exposed as frame {}: --exposure {}", k,
                              number_words(*exposure)));
    }
  }
  if (there > 0)
    common.note(there == 1 ? "1 frame was there already"
                           : fmt::format("{} frames were there already", there));
  return 0;
}

}  // namespace tdpt
