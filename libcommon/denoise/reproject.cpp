#include "libcommon/denoise/reproject.h"

#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {
namespace {

// Depths that differ by less than this share are of the same surface.
constexpr double kSameDepth = 0.03;
constexpr size_t kNone = ~size_t{0};

// The pixel of `from` that shows what `to` shows in the middle of pixel (x, y).
size_t pixel_that_shows(const View& from, const View& to, int x, int y) {
  const auto index = [](const View& view, int column, int row) {
    return static_cast<size_t>(row) * static_cast<size_t>(view.film.width()) +
           static_cast<size_t>(column);
  };
  const float depth = to.depth[index(to, x, y)];
  Vec3d w = to.film.direction(x + 0.5, y + 0.5);
  double expected = 0;
  if (!(depth > 0)) return kNone;
  const bool nothing = !(depth < kNothing);
  if (!nothing) {
    const double along = static_cast<double>(depth) / dot(w, to.film.forward());
    const Vec3d away = to.film.position() + w * along - from.film.position();
    expected = dot(away, from.film.forward());
    if (!(length(away) > 0)) return kNone;
    w = normalize(away);
  }
  double u, v;
  if (!from.film.raster(w, u, v)) return kNone;
  const size_t pixel = index(from, static_cast<int>(u), static_cast<int>(v));
  const float found = from.depth[pixel];
  if (nothing) return found < kNothing ? kNone : pixel;
  return std::abs(static_cast<double>(found) - expected) < kSameDepth * expected ? pixel : kNone;
}

}  // namespace

Neighbour reproject(const Shot& there, const View& from, const Shot& here, const View& to) {
  Neighbour all{here, Plane(to.depth.size())};
  all.shot.share_a = there.share_a;
  tbb::parallel_for(0, to.film.height(), [&](int y) {
    for (int x = 0; x < to.film.width(); ++x) {
      const size_t pixel = pixel_that_shows(from, to, x, y);
      if (pixel == kNone) continue;
      const size_t i =
          static_cast<size_t>(y) * static_cast<size_t>(to.film.width()) + static_cast<size_t>(x);
      all.present[i] = 1;
      for (size_t c = 0; c < 3; ++c) {
        all.shot.a[c][i] = there.a[c][pixel];
        all.shot.b[c][i] = there.b[c][pixel];
      }
      // The depth, the last feature, is that from here.
      for (size_t f = 0; f + 1 < kFeatures; ++f) all.shot.features[f][i] = there.features[f][pixel];
    }
  });
  return all;
}

}  // namespace tdpt::denoise
