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

// Frames side by side, the first at the left. Sizes never grow; each pixel is the mean of its share
// of the frame.
struct Strip {
  Picture picture;
  int width = 0;  ///< of each frame

  Strip(const Picture& first, int count) {
    const double scale =
        std::min(1.0, kLongerSide / static_cast<double>(std::max(first.width, first.height)));
    width = std::max(1, static_cast<int>(std::lround(first.width * scale)));
    picture.width = width * count;
    picture.height = std::max(1, static_cast<int>(std::lround(first.height * scale)));
    picture.pixels.resize(static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  }

  void place(const Picture& frame, int at) {
    const auto index = [](const Picture& p, int x, int y) {
      return static_cast<size_t>(y) * static_cast<size_t>(p.width) + static_cast<size_t>(x);
    };
    const auto edge = [](int i, int to, int all) {
      return static_cast<int>(int64_t{i} * all / to);
    };
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < width; ++x) {
        const int x0 = edge(x, width, frame.width), x1 = edge(x + 1, width, frame.width);
        const int y0 = edge(y, picture.height, frame.height);
        const int y1 = edge(y + 1, picture.height, frame.height);
        Vec3d sum;
        for (int v = y0; v < y1; ++v)
          for (int u = x0; u < x1; ++u) sum += Vec3d(frame.pixels[index(frame, u, v)]);
        picture.pixels[index(picture, at * width + x, y)] = Rgb(sum / ((x1 - x0) * (y1 - y0)));
      }
  }
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
  const Json filtered = Json::parse(read_file(filter));
  if (filtered.contains("relmse"))
    stats["filtered"] = {{"relmse", filtered["relmse"]}, {"interval", filtered["interval"]}};
  write_output(path, stats.dump() + "\n");
}

void gather_shot(const Arguments& a, const Request& request, const std::string& folder) {
  const FrameRange range = frame_range(a.shot);
  const auto path_of = [&](int64_t frame) { return name_of_frame("-o", request.picture, frame); };
  // Frames evenly among all, with both ends.
  const int64_t n = std::min(range.count(), kMostPictures);
  std::vector<int64_t> shown;
  std::optional<Strip> strip;
  for (int64_t i = 0; i < n; ++i) {
    shown.push_back(range.first + i * (range.count() - 1) / std::max(n - 1, int64_t{1}));
    const Picture picture = read_exr(path_of(shown.back())).picture;
    if (!strip) strip.emplace(picture, static_cast<int>(n));
    strip->place(picture, static_cast<int>(i));
  }
  const double exposure = a.exposure.value_or(auto_exposure(strip->picture));
  Json all_stats = Json::array();
  for (int64_t k = range.first; k <= range.last; ++k) {
    Json stats = stats_in(name_of_frame("--stats", request.stats, k));
    const bool of_this =
        !stats.is_null() && stats["frame"].is_string() &&
        frame_mark_in(path_of(k)).starts_with(stats["frame"].get_ref<const std::string&>());
    all_stats.push_back(of_this ? std::move(stats) : Json());
  }
  const Json shot{{"scene", std::filesystem::path(a.scene).filename().string()},
                  {"first", range.first},
                  {"last", range.last},
                  {"fps", a.shot.fps},
                  {"exposure", exposure},
                  {"shown", shown},
                  {"width", strip->width},
                  {"height", strip->picture.height},
                  {"stats", all_stats}};
  write_output(folder + "/strip.png", preview_bytes(strip->picture, exposure));
  write_output(folder + "/shot.json", shot.dump(1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace tdpt
