#include "tools/tdpt-render/run/picture_size.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/memory_limit.h"

namespace tdpt {

PictureSize picture_size(const Camera& camera, int64_t width, int64_t height) {
  constexpr int64_t kMostOnASide = 65536, kMost = int64_t{1} << 27;
  constexpr uint64_t kSums = uint64_t{3} * 16;  // bytes of a pixel without layers [film.h]
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const auto at_least_1 = [](double v) { return std::llround(std::clamp(v, 1.0, 1e6)); };
  if (width == 0 && height == 0) width = 640;
  if (width == 0) width = at_least_1(static_cast<double>(height) * aspect);
  if (height == 0) height = at_least_1(static_cast<double>(width) / aspect);
  if (width > kMostOnASide || height > kMostOnASide || width * height > kMost)
    throw UsageError(fmt::format("a picture of {} x {} pixels is too large, at most {} pixels",
                                 width, height, kMost));
  const auto film = static_cast<uint64_t>(width * height) * kSums;
  if (film > memory_limit())
    throw UsageError(fmt::format(
        "a film of {} x {} pixels (--width, --height) takes {} of memory at least, expected at "
        "most the {} of --max-memory",
        width, height, size_words(film), size_words(memory_limit())));
  return {static_cast<int>(width), static_cast<int>(height)};
}

PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height) {
  const SceneDefaults& own = scene.defaults;
  if (width > 0 || height > 0) return picture_size(camera, width, height);
  try {
    return picture_size(camera, own.width, own.height);
  } catch (const UsageError& e) {
    throw InputError(display_name(scene.path),
                     own.place_of(own.width > 0 ? "tdpt_width" : "tdpt_height"), e.what());
  }
}

}  // namespace tdpt
