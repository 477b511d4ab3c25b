#include "tools/tdpt/shot_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/tone.h"

namespace tdpt {
namespace {

using Json = nlohmann::json;

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

// Each pixel is the mean of its share of the large ones; sizes never grow.
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

// Pictures of one size, made small, from left to right.
class Strip {
 public:
  Strip(const Picture& first, size_t count) {
    const double scale =
        std::min(1.0, kLongerSide / static_cast<double>(std::max(first.width, first.height)));
    width_ = std::max(1, static_cast<int>(std::lround(first.width * scale)));
    all_.width = width_ * static_cast<int>(count);
    all_.height = std::max(1, static_cast<int>(std::lround(first.height * scale)));
    all_.pixels.resize(static_cast<size_t>(all_.width) * static_cast<size_t>(all_.height));
  }

  void add(const Picture& frame) {
    const Picture small = made_small(frame, width_, all_.height);
    const auto across = static_cast<size_t>(width_);
    for (size_t y = 0; y < static_cast<size_t>(all_.height); ++y)
      std::copy_n(&small.pixels[y * across], across,
                  &all_.pixels[y * static_cast<size_t>(all_.width) + added_ * across]);
    ++added_;
  }
  const Picture& picture() const { return all_; }
  int width() const { return width_; }  ///< of each

 private:
  Picture all_;
  int width_ = 0;
  size_t added_ = 0;
};

// The mark by which tdpt-render knows a frame of a shot, in a picture; empty for other files.
std::string frame_mark_in(const std::string& path) {
  try {
    const ExrFile file = read_exr(path);
    const auto mark = file.attributes.find(kFrameAttribute);
    return mark == file.attributes.end() ? "" : mark->second;
  } catch (const InputError&) {
    return "";
  }
}

// Statistics of a frame, without how it formed; null for other files.
Json stats_in(const std::string& path) {
  std::string text;
  try {
    text = read_file(path);
  } catch (const InputError&) {
    return {};
  }
  Json json = nested_too_deep(text) ? Json() : Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("frame")) return {};
  json.erase("frames");
  return json;
}

}  // namespace

std::string stats_beside(const std::string& frames) {
  return std::filesystem::path(frames).replace_extension(".stats.json").string();
}

void check_is_frame(const std::string& path) {
  std::error_code failed;
  if (std::filesystem::is_regular_file(path, failed) && frame_mark_in(path).empty())
    throw UsageError(path + ": is there already, and is no frame of a shot; --force replaces it");
}

void check_is_stats(const std::string& path) {
  std::error_code failed;
  if (std::filesystem::exists(path, failed) && stats_in(path).is_null())
    throw UsageError(path +
                     ": is there already, and is no statistics of a frame; --force replaces it");
}

void write_filtered_stats(const std::string& noisy, const std::string& filter,
                          const std::string& path) {
  auto stats = nlohmann::ordered_json::parse(read_file(noisy));
  const Json told = Json::parse(read_file(filter));
  if (told.contains("relmse"))
    stats["filtered"] = {{"relmse", told["relmse"]}, {"interval", told["interval"]}};
  write_output(path, stats.dump() + "\n");
}

void gather_shot(const Arguments& a, const Request& request, const std::string& folder) {
  const FrameRange range = frame_range(a.shot);
  const std::vector<int64_t> shown = shown_of(range);
  const auto path_of = [&](int64_t frame) { return name_of_frame("-o", request.picture, frame); };
  std::optional<Strip> strip;
  for (const int64_t frame : shown) {
    const Picture picture = read_exr(path_of(frame)).picture;
    if (!strip) strip.emplace(picture, shown.size());
    strip->add(picture);
  }
  const double exposure = a.exposure.value_or(auto_exposure(strip->picture()));
  Json stats = Json::array();
  for (int64_t k = range.first; k <= range.last; ++k) {
    Json told = stats_in(name_of_frame("--stats", request.stats, k));
    const bool of_this =
        !told.is_null() && told["frame"].is_string() &&
        frame_mark_in(path_of(k)).starts_with(told["frame"].get_ref<const std::string&>());
    stats.push_back(of_this ? std::move(told) : Json());
  }
  const Json told{{"scene", std::filesystem::path(a.scene).filename().string()},
                  {"first", range.first},
                  {"last", range.last},
                  {"fps", a.shot.fps},
                  {"exposure", exposure},
                  {"shown", shown},
                  {"width", strip->width()},
                  {"height", strip->picture().height},
                  {"stats", stats}};
  write_output(folder + "/strip.png", preview_bytes(strip->picture(), exposure));
  write_output(folder + "/shot.json", told.dump(1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace tdpt
