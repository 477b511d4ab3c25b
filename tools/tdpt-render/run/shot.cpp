// A shot: its frames, each rendered as a picture of its own.
#include <chrono>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/words.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/tone.h"
#include "tools/tdpt-render/run/options.h"
#include "tools/tdpt-render/run/picture.h"
#include "tools/tdpt-render/run/progress.h"

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

// Hashes of the portal files of a frame; those that all frames share are read already.
std::vector<std::string> portals_of(const FrameCommand& frame, const RenderArguments& shot,
                                    const LoadedScene& in) {
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

int render_shot(const RenderArguments& a, const cli::Common& common, SceneCache& scenes) {
  const FrameRange range = frame_range(a.shot);
  const FrameCommand first = frame_command(a, common, range.first);
  const LoadedScene& in = scenes.load(first.a, first.common);
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
    const FrameCommand frame = frame_command(a, common, k);
    expose(frame);
    write_output(frame.a.preview, preview_bytes(read_exr(frame.common.output).picture, *exposure));
  }
  const auto start = std::chrono::steady_clock::now();
  for (size_t done = 0; done < missing.size(); ++done) {
    FrameCommand frame = frame_command(a, common, missing[done]);
    frame.a.exposure = exposure;
    frame.common.quiet = common.quiet || done > 0;  // the first tells what all have
    check_checkpoint(frame.a);
    const Outcome made = render_picture(frame.a, frame.common, scenes, frame.number);
    if (made.code != 0) return made.code;
    expose(frame);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    common.note(fmt::format("frame {}: {}; {}", frame.number, made.words,
                            progress_words(done + 1, missing.size(), took.count())));
  }
  return 0;
}

}  // namespace tdpt
