#include "tools/tdpt/first_look.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"

namespace tdpt {
namespace {

constexpr int64_t kSmall = 320;  // pixels on the longer side
constexpr int64_t kMost = 1024;  // samples per pixel
constexpr int kNice = 10;        // after the small picture the stages have priority

// Drops an option and its value, as request_of() writes them; "--set retry" names a setting.
void drop(Words& words, const std::string& option, bool has_value) {
  const bool setting = option.starts_with("--set ");
  for (auto at = words.begin(); at != words.end();) {
    const bool joined = at->starts_with(option + "=");
    const bool set = setting && *at == "--set" && at + 1 != words.end() &&
                     (at + 1)->starts_with(option.substr(6) + "=");
    if (*at != option && !joined && !set) {
      ++at;
      continue;
    }
    at = words.erase(at);
    if (has_value && !joined && at != words.end()) at = words.erase(at);
  }
}

}  // namespace

FirstLook::FirstLook(const Arguments& a, const Request& request, const std::string& programs,
                     const std::string& folder, const std::string& preview)
    : picture_(folder + "/look.exr"),
      png_(folder + "/look.png"),
      preview_(preview),
      width_(a.width),
      height_(a.height) {
  Words shape = request.render;
  for (const char* option : {"--integrator", "--set guide-light", "--set guide-camera",
                             "--set segments", "--set light-walks", "--width", "--height"})
    drop(shape, option, true);
  drop(shape, "--layers", false);
  base_ = {programs + "/tdpt-render", request.scene};
  for (const Words& words :
       {request.camera, request.pose, request.shot, request.sky, request.unshaped, shape})
    base_.insert(base_.end(), words.begin(), words.end());
  for (const char* word :
       {"--integrator", "bdpt", "--quiet", "--set", "progress=none", "--preview"})
    base_.emplace_back(word);
  if (a.exposure) base_.push_back(fmt::format("--exposure={}", *a.exposure));
  begin();
}

void FirstLook::begin() {
  Words words = base_;
  const auto add = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  // The small picture has the aspect of the final one, if the command line sets it.
  const int64_t larger = std::max(width_, height_);
  const double scale =
      spp_ > 0 || larger == 0 ? 1 : std::min(1.0, kSmall / static_cast<double>(larger));
  for (const auto& [option, side] : {std::pair("--width", width_), {"--height", height_}})
    if (side > 0)
      add(option,
          std::to_string(std::max<int64_t>(1, std::llround(scale * static_cast<double>(side)))));
  if (spp_ == 0 && larger == 0) add("--width", std::to_string(kSmall));
  add("--spp", std::to_string(std::max<int64_t>(spp_, 1)));
  add("-o", picture_);
  ChildProcess::How how;
  how.niceness = spp_ == 0 ? 0 : kNice;
  child_ = std::make_unique<ChildProcess>(words, how);
}

void FirstLook::tick() {
  if (!child_) return;
  std::string unheard;  // discarded: the picture's renderer will say it all
  child_->read(unheard);
  const auto code = child_->exit_code();
  if (!code) return;
  child_.reset();
  if (*code != 0) return;
  try {
    write_output(preview_, read_file(png_));
  } catch (const Error&) {
    return;  // the final write will report an error
  }
  spp_ = spp_ == 0 ? 1 : 2 * spp_;
  if (spp_ <= kMost) begin();
}

}  // namespace tdpt
