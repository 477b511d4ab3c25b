#include "tools/tdpt/shot_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "libcommon/base/output_file.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/tone.h"

namespace tdpt {
namespace {

constexpr int64_t kMostPictures = 48;  // in a strip
constexpr int kLongerSide = 240;       // of each [pixels]

// Evenly among all, with both ends.
std::vector<int64_t> shown_of(const FrameRange& range) {
  const int64_t n = std::min(range.count(), kMostPictures);
  std::vector<int64_t> shown;
  for (int64_t i = 0; i < n; ++i)
    shown.push_back(range.first + (n > 1 ? i * (range.count() - 1) / (n - 1) : 0));
  return shown;
}

// Each pixel is the mean of those that it covers the middle of.
Picture made_small(const Picture& large, int width, int height) {
  Picture small{width, height, {}};
  const auto edge = [](int i, int of, int all) { return static_cast<int>(int64_t{i} * all / of); };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x0 = edge(x, width, large.width), x1 = edge(x + 1, width, large.width);
      const int y0 = edge(y, height, large.height), y1 = edge(y + 1, height, large.height);
      Vec3d sum;
      for (int v = y0; v < y1; ++v)
        for (int u = x0; u < x1; ++u)
          sum += Vec3d(large.pixels[static_cast<size_t>(v) * static_cast<size_t>(large.width) +
                                    static_cast<size_t>(u)]);
      small.pixels.emplace_back(Vec3f(sum / ((x1 - x0) * (y1 - y0))));
    }
  return small;
}

// Pictures of one size, from left to right.
class Strip {
 public:
  explicit Strip(size_t count) : count_(count) {}

  void add(const Picture& frame) {
    if (added_ == 0) begin(frame);
    const Picture small = made_small(frame, width_, height_);
    for (size_t y = 0; y < size_t(height_); ++y)
      std::copy_n(&small.pixels[y * size_t(width_)], width_,
                  &all_.pixels[y * size_t(all_.width) + added_ * size_t(width_)]);
    ++added_;
  }
  const Picture& picture() const { return all_; }
  int width() const { return width_; }

 private:
  void begin(const Picture& first) {
    const double scale =
        std::min(1.0, kLongerSide / static_cast<double>(std::max(first.width, first.height)));
    width_ = std::max(1, static_cast<int>(std::lround(first.width * scale)));
    height_ = std::max(1, static_cast<int>(std::lround(first.height * scale)));
    all_.width = width_ * static_cast<int>(count_);
    all_.height = height_;
    all_.pixels.resize(static_cast<size_t>(all_.width) * static_cast<size_t>(height_));
  }

  size_t count_, added_ = 0;
  int width_ = 0, height_ = 0;
  Picture all_;
};

}  // namespace

std::string stats_of_shot(const Arguments& a, const std::string& frames) {
  if (!a.stats.empty()) return a.stats;
  return std::filesystem::path(frames).replace_extension(".stats.json").string();
}

void gather_shot(const Arguments& a, const std::string& frames, const std::string& folder) {
  const FrameRange range = frame_range(a.shot);
  const std::vector<int64_t> shown = shown_of(range);
  Strip strip(shown.size());
  for (const int64_t frame : shown) strip.add(read_exr(name_of_frame("-o", frames, frame)).picture);
  const double exposure = a.exposure.value_or(auto_exposure(strip.picture()));
  std::vector<std::string> stats;
  for (int64_t k = range.first; k <= range.last; ++k)
    stats.push_back(name_of_frame("--stats", stats_of_shot(a, frames), k));
  const nlohmann::json told{{"scene", std::filesystem::path(a.scene).filename().string()},
                            {"first", range.first},
                            {"last", range.last},
                            {"fps", a.shot.fps},
                            {"exposure", exposure},
                            {"shown", shown},
                            {"width", strip.width()},
                            {"height", strip.picture().height},
                            {"stats", stats}};
  write_output(folder + "/strip.png", preview_bytes(strip.picture(), exposure));
  write_output(folder + "/shot.json",
               told.dump(1, ' ', true, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace tdpt
