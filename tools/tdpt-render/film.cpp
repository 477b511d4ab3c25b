#include "tools/tdpt-render/film.h"

#include <cmath>

namespace tdpt {

Film::Film(int width, int height, double brightest)
    : width_(width),
      height_(height),
      unit_(std::exp2(std::ceil(std::log2(brightest > 0 ? brightest : 1.0)) - 34)),
      camera_(static_cast<size_t>(width) * static_cast<size_t>(height)),
      splats_(std::make_unique<std::array<std::atomic<int64_t>, 3>[]>(camera_.size())) {}

bool Film::splat(int x, int y, const Rgb& radiance) {
  if (max_component(radiance) / unit_ > 0x1p62) return false;
  auto& sums = splats_[index(x, y)];
  for (int c = 0; c < 3; ++c)
    sums[static_cast<size_t>(c)].fetch_add(std::llround(radiance[c] / unit_),
                                           std::memory_order_relaxed);
  return true;
}

Picture Film::resolve(uint64_t spp) const {
  Picture picture{width_, height_, {}};
  picture.pixels.reserve(camera_.size());
  const double share = spp > 0 ? 1.0 / static_cast<double>(spp) : 0;
  for (size_t i = 0; i < camera_.size(); ++i) {
    const auto splat = [&](size_t c) {
      return unit_ * static_cast<double>(splats_[i][c].load(std::memory_order_relaxed));
    };
    const Vec3d sum = camera_[i] + Vec3d{splat(0), splat(1), splat(2)};
    picture.pixels.push_back(Vec3f(sum * share));
  }
  return picture;
}

}  // namespace tdpt
