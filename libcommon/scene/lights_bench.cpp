// Cost of sampling a point on a light among 1, 100, ... lamps: time relative to one lamp, from
// interleaved runs.
#include <chrono>
#include <cstdio>

#include "libcommon/scene/lights.h"

namespace {
using namespace tdpt;

Scene lamps(uint32_t n) {
  Scene s;
  s.materials.resize(1);
  s.materials[0].emission = Rgb(1);
  for (uint32_t i = 0; i < n; ++i) {
    const float x = static_cast<float>(i % 1000) * 1e-3f, y = static_cast<float>(i / 1000) * 1e-3f;
    const auto first = static_cast<uint32_t>(s.positions.size());
    s.positions.insert(s.positions.end(), {{x, y, 0}, {x + 5e-4f, y, 0}, {x, y + 5e-4f, 0}});
    s.triangles.push_back({{first, first + 1, first + 2}, 0});
  }
  return s;
}

double seconds(const LightSelection& selection, uint64_t draws) {
  const auto start = std::chrono::steady_clock::now();
  double sum = 0;
  for (uint64_t i = 0; i < draws; ++i) {
    Rng rng(1, 0, i);
    sum += selection.sample(rng).position.x;
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  return sum < 0 ? 0 : taken.count();
}
}  // namespace

int main() {
  constexpr uint64_t kDraws = 1 << 20;
  const Scene one = lamps(1);
  const Lights single(one);
  std::printf("lamps  ns per draw  against one lamp\n");
  for (uint32_t n : {1u, 100u, 10000u, 1000000u}) {
    const Scene scene = lamps(n);
    const Lights lights(scene);
    double own = 1e9, base = 1e9;
    for (int round = 0; round < 5; ++round) {
      base = std::min(base, seconds(LightSelection(single), kDraws));
      own = std::min(own, seconds(LightSelection(lights), kDraws));
    }
    std::printf("%7u  %8.1f  %6.2f\n", n, 1e9 * own / kDraws, own / base);
  }
}
