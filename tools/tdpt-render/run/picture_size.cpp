#include "tools/tdpt-render/run/picture_size.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

PictureSize picture_size(const Camera& camera, int64_t width, int64_t height) {
  constexpr int64_t kMostOnASide = 65536, kMost = int64_t{1} << 27;
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const auto at_least_1 = [](double v) { return std::llround(std::clamp(v, 1.0, 1e6)); };
  if (width == 0 && height == 0) width = 640;
  if (width == 0) width = at_least_1(static_cast<double>(height) * aspect);
  if (height == 0) height = at_least_1(static_cast<double>(width) / aspect);
  if (width > kMostOnASide || height > kMostOnASide || width * height > kMost)
    throw UsageError(fmt::format("a picture of {} x {} pixels is too large, at most {} pixels",
                                 width, height, kMost));
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

void expect_memory_of_film(const RenderArguments& a, const PictureSize& size) {
  const TechniqueSet techniques = a.integrator != "auto"
                                      ? integrator_named(a.integrator).mixture.techniques
                                      : (a.portals.empty() ? kTwoWays : kThreeWays);
  const bool halves = keeps_halves(a);
  const Film::Options sums = film_options(a.layers ? techniques : TechniqueSet(), a.alpha, halves);
  expect_memory(fmt::format("{} x {} pixels (--width, --height{}{})", size.width, size.height,
                            a.layers ? ", --layers" : "", halves ? ", --denoise or --aov" : ""),
                sums.bytes_of_pixel() * static_cast<uint64_t>(size.width) *
                    static_cast<uint64_t>(size.height));
}

}  // namespace tdpt
