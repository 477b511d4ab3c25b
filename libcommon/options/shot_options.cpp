#include "libcommon/options/shot_options.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt {

namespace {

constexpr double kLongest = 1e6;                     // seconds
constexpr double kSlowest = 0.001, kFastest = 1000;  // frames per second

}  // namespace

void declare_shot_options(cli::Options& options, ShotArguments& a, cli::Effect frames) {
  options.part(cli::Part::animation);
  options.option("--frames", a.frames, "A-B",
                 "Frames of the scene's animations, A to B; frame K shows it at K / --fps seconds",
                 frames);
  options.option("--fps", a.fps, "F", "Frames per second; default 24", kSlowest, kFastest);
}

std::string words_of(const FrameRange& frames) {
  return frames.count() == 1 ? fmt::format("{}", frames.first)
                             : fmt::format("{}-{}", frames.first, frames.last);
}

FrameRange frame_range(const ShotArguments& a) {
  FrameRange range;
  const std::string& text = a.frames;
  const char* const end = text.data() + text.size();
  auto [at, error] = std::from_chars(text.data(), end, range.first);
  range.last = range.first;
  if (error == std::errc() && at != end && *at == '-') {
    const auto second = std::from_chars(at + 1, end, range.last);
    at = second.ptr, error = second.ec;
  }
  if (error != std::errc() || at != end || text.starts_with('-') || range.last < 0 ||
      std::max(range.first, range.last) > kLastFrame)
    throw UsageError(fmt::format("--frames {}: expected A-B, as 1-48, or one number, up to {}",
                                 text, kLastFrame));
  if (range.last < range.first)
    throw UsageError(
        fmt::format("--frames {}: runs backwards; meant {}-{}?", text, range.last, range.first));
  return range;
}

void check_shot(const ShotArguments& a, const Pose& pose) {
  if (!a.is_given()) return;
  frame_range(a);
  if (pose.seconds) throw UsageError("--at: the frames of --frames say which time they show");
}

std::string camera_at_frame(const std::string& camera, int64_t frame) {
  return fmt::format("{}, frame {}", camera, frame);
}

std::optional<int64_t> frame_of_camera(const std::string& name, const std::string& camera) {
  const std::string before = camera + ", frame ";
  if (!name.starts_with(before)) return {};
  int64_t frame = 0;
  const char* const end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + before.size(), end, frame);
  if (read.ec != std::errc() || read.ptr != end) return {};
  return frame;
}

namespace {

// A pattern's name: what stands before its number, how many digits that has at least, what follows.
struct Pattern {
  std::string before, after;
  size_t digits = 0;  // 0: there is no number
};

Pattern pattern_of(const std::string& name) {
  const size_t folder = name.find_last_of('/'), last = name.find_last_of('#');
  if (last == std::string::npos || (folder != std::string::npos && last < folder)) return {};
  const size_t other = name.find_last_not_of('#', last);
  const size_t first = other == std::string::npos ? 0 : other + 1;
  return {name.substr(0, first), name.substr(last + 1), last - first + 1};
}

}  // namespace

bool has_frame_number(const std::string& pattern) {
  return pattern_of(pattern).digits > 0;
}

std::string name_of_frame(const std::string& option, const std::string& pattern, int64_t frame) {
  const Pattern p = pattern_of(pattern);
  if (p.digits == 0)
    throw UsageError(
        fmt::format("{} {}: there are several frames; write #### where their numbers "
                    "are to stand",
                    option, pattern));
  return fmt::format("{}{:0{}}{}", p.before, frame, p.digits, p.after);
}

void declare_pose_options(cli::Options& options, Pose& pose, cli::Effect effect) {
  options.part(cli::Part::animation);
  options.option("--at", pose.seconds, "SECONDS",
                 "Take the scene at this time of its animations; default their beginning",
                 -kLongest, kLongest, effect);
  options.option("--animation", pose.animations, "NAME",
                 "Apply this animation alone; may be repeated; default all, the first of two that "
                 "move the same thing",
                 effect);
}

}  // namespace tdpt
