// A small light grid with all that one can hold, for tests of its files.
#pragma once
#include <gtest/gtest.h>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/rng.h"

namespace tdpt::testing {

inline LightGrid small_light_grid(uint64_t lines = 40) {
  LightGrid g;
  g.origin = {-1, 0.1, 1e-7};
  g.voxel = 0.3;
  g.dim = {5, 4, 3};
  g.count.assign(60, 0);
  g.air.assign(60, 1);
  g.direction.assign(60, {});
  g.air[g.index(1, 1, 1)] = 0;
  for (uint64_t n = 0; n < lines; ++n) {
    Rng rng(1, 2, n);
    g.count[n] = static_cast<float>(1 + rng.below(1 << 24));
    for (int c = 0; c < 3; ++c) g.direction[n][c] = 2 * rng.uniform_float() - 1;
    LightLine line{g.origin, g.origin, rng.below(2)};
    for (int c = 0; c < 3; ++c) line.light[c] += rng.uniform();
    for (int c = 0; c < 3; ++c) line.camera[c] += rng.uniform() * 0.9;
    g.lines.push_back(line);
    g.probes.push_back({line, n % 3 == 0});
  }
  g.scene_hash = "abc";
  g.cameras = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  g.cuts = {{0.01, 0.5}, {1.0 / 3, 1}};
  g.walls = {{0, 1, 0}, {0.6, 0, -0.8}};
  g.panes = {{{0, 1.0 / 3, 0}, {0, 0.3, 0}}, {{1, 2, 3}, {1, 2, 3.01}}};
  g.provenance.lines = {"made by lightgrid 1: lightgrid", "from a b", "made by x 1: x", "from a b"};
  return g;
}

/// But for lines, probes and provenance.
inline void expect_same_but_lines(const LightGrid& a, const LightGrid& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.voxel, b.voxel);
  EXPECT_EQ(a.dim, b.dim);
  EXPECT_EQ(a.count, b.count);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.air, b.air);
  EXPECT_EQ(a.scene_hash, b.scene_hash);
  EXPECT_EQ(a.cameras, b.cameras);
  EXPECT_EQ(a.flux_share, b.flux_share);
  EXPECT_EQ(a.cuts, b.cuts);
  EXPECT_EQ(a.walls, b.walls);
  EXPECT_EQ(a.panes, b.panes);
  EXPECT_EQ(a.bottleneck, b.bottleneck);
  EXPECT_EQ(a.reason, b.reason);
}

/// The lines of both, in any order, with ends at most `within` apart [metres].
inline void expect_same_lines(const LightGrid& a, const LightGrid& b, double within) {
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (const LightLine& line : b.lines) {
    const bool found = std::any_of(a.lines.begin(), a.lines.end(), [&](const LightLine& other) {
      return length(line.light - other.light) <= within &&
             length(line.camera - other.camera) <= within && line.cut == other.cut;
    });
    EXPECT_TRUE(found);
  }
}

}  // namespace tdpt::testing
