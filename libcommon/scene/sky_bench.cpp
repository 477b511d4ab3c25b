// Costs of a sky, from one colour to the largest maps that are read: setting up its distribution,
// sampling, evaluating the density, and radiance for a ray that leaves.
#include <chrono>
#include <cstdio>
#include <functional>

#include "libcommon/base/process.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/sky.h"

namespace {
using namespace tdpt;

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Sky::Map noise(int width, int height) {
  Sky::Map map{width, height, {}};
  Rng rng(1, 0, 0);
  const size_t n = static_cast<size_t>(width) * static_cast<size_t>(height);
  map.texels.reserve(n);
  for (size_t i = 0; i < n; ++i) map.texels.emplace_back(static_cast<float>(rng.uniform()));
  return map;
}

// Time of one call of f(i) [ns], the best of five rounds.
template <class F>
double cost(const F& f) {
  constexpr uint64_t kCalls = 1 << 19;
  double best = 1e9;
  for (int round = 0; round < 5; ++round)
    best = std::min(best, seconds([&] {
                      double sum = 0;
                      for (uint64_t i = 0; i < kCalls; ++i) sum += f(i);
                      if (sum < 0) std::puts("");
                    }));
  return 1e9 * best / kCalls;
}
}  // namespace

int main() {
  std::vector<Vec3d> directions;
  const Sky even({1, 1, {Rgb(1)}}, 0);
  const SkyDirections all_around(even);
  for (uint64_t i = 0; i < 4096; ++i) {
    Rng rng(2, 0, i);
    const double pick = rng.uniform();
    const double u = rng.uniform();
    const double v = rng.uniform();
    directions.push_back(all_around.sample(pick, u, v));
  }
  const auto direction = [&](uint64_t i) { return directions[i % directions.size()]; };
  std::printf("        map  set up [s]  peak [MiB]  radiance  pdf_w  sample [ns]\n");
  for (const int width : {1, 512, 2048, 4096, 8192}) {
    const Sky sky(width == 1 ? Sky::Map{1, 1, {Rgb(1)}} : noise(width, width / 2), 0.3);
    SkyDirections d;
    const double set_up = seconds([&] { d = SkyDirections(sky); });
    const double radiance = cost([&](uint64_t i) { return sky.radiance(direction(i)).x; });
    const double pdf = cost([&](uint64_t i) { return d.pdf_w(direction(i)); });
    const double sample = cost([&](uint64_t i) {
      const double u = static_cast<double>(mix64(i) >> 11) * 0x1p-53;
      return d.sample(u, u, 1 - u).x + 2;
    });
    std::printf("%5d x %4d %10.3f %11.0f %9.1f %6.1f %7.1f\n", width, std::max(1, width / 2),
                set_up, static_cast<double>(peak_memory()) / 1048576, radiance, pdf, sample);
  }
}
