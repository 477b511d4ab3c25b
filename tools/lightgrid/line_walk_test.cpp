#include "tools/lightgrid/lightgrid.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::line_walk_test {

constexpr double kHole = 0.2;  // half its side
constexpr uint64_t kSeed = 5;

// The box [-1,1]^3, divided by an infinitely thin wall at x = 0 with a square hole in its middle.
// The light's side is x < 0. Only the box and the wall block lines; votes succeed with a
// probability that is a function of the line.
class TwoHalves : public LineTracer {
 public:
  using Votes = std::function<double(const LightLine&)>;
  TwoHalves(const Scene& scene, const LineTables& tables, const LightGrid& grid, Votes votes)
      : LineTracer(scene, tables, grid, kSeed), votes_(std::move(votes)) {}
  void clear() override {}
  void counts(std::vector<uint32_t>&) override {}
  void take_directions(std::vector<Vec3d>&) override {}

  // The line through a point along a non-zero direction, oriented away from the light; returns
  // whether it passes the hole.
  static bool line_through(const Vec3d& place, const Vec3d& w, LightLine& line) {
    const auto end = [&](const Vec3d& d) {
      double t = INFINITY;
      for (int c = 0; c < 3; ++c)
        if (d[c] != 0) t = std::min(t, ((d[c] > 0 ? 1 : -1) - place[c]) / d[c]);
      if (const double wall = -place.x / d.x; wall > 0 && wall < t) {
        const Vec3d at = place + d * wall;
        if (std::max(std::abs(at.y), std::abs(at.z)) > kHole) t = wall;
      }
      return place + d * t;
    };
    line.light = end(w), line.camera = end(-w);
    if (line.light.x > line.camera.x) std::swap(line.light, line.camera);
    return line.light.x < -1e-6 && line.camera.x > 1e-6;
  }

 protected:
  void trace_segments(const shader::LightParameters&, TracedLines&) override { ADD_FAILURE(); }
  void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                   TracedLines& out) override {
    for (size_t i = 0; i < tries.size(); ++i) {
      out.fate[i] = LineFate::none;
      const Vec3d place(tries[i].place), w(tries[i].direction);
      if (dot(w, w) == 0) continue;
      LightLine line;
      const bool joins = line_through(place, w, line);
      out.ends[i].light = Vec3f(line.light), out.ends[i].camera = Vec3f(line.camera);
      Rng rng(kSeed, 1, i, p.round);
      out.fate[i] = joins && rng.uniform() < votes_(line) ? LineFate::joins : LineFate::same_side;
    }
  }

 private:
  Votes votes_;
};

// Every other of many stripes of slope: half of the lines, and about half in every voxel, so that W
// is the same for them as for the rest.
bool in_stripe(const LightLine& l) {
  const double slope = (l.camera.y - l.light.y) / (l.camera.x - l.light.x);
  return std::fmod(8 * (slope + 100), 2) < 1;
}

// Share of the resulting lines that are in stripes. `start`: the same share among the initial
// lines.
double share_in_stripes(const TwoHalves::Votes& votes, double start) {
  const Scene scene;
  LineTables tables;
  tables.cuts.resize(1);
  LightGrid grid;
  grid.origin = {-1, -1, -1};
  grid.dim = {40, 40, 40};
  grid.voxel = 0.05;
  grid.count.assign(64000, 0);
  std::vector<uint32_t> count(64000, 0);
  std::vector<LightLine> kept;
  for (uint64_t i = 0; i < 4000; ++i) {
    Rng rng(kSeed, 2, i);
    const double y = kHole * (2 * rng.uniform() - 1);
    const double z = kHole * (2 * rng.uniform() - 1);
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = cosine_hemisphere(u, v);
    LightLine line;
    if (!TwoHalves::line_through({0, y, z}, {w.z, w.x, w.y}, line)) continue;
    if (rng.uniform() >= (in_stripe(line) ? start : 1 - start)) continue;
    kept.push_back({line});
    walk_grid(grid, line.light, line.camera, [&](size_t at, double) { ++count[at]; });
  }
  TwoHalves tracer(scene, tables, grid, votes);
  const LineWalk walk = walk_among_lines(scene, tracer, 0, grid, count, kept, 8192, kSeed);
  EXPECT_GT(walk.lines.size(), 4000u);
  return static_cast<double>(std::count_if(walk.lines.begin(), walk.lines.end(), in_stripe)) /
         static_cast<double>(walk.lines.size());
}

// Every chain moves six times on average, so some of the start remains.
constexpr double kStays = 0.1;

// The share settles, however the coarse pass was distorted.
double expect_settled(const TwoHalves::Votes& votes, double settled) {
  const double found = share_in_stripes(votes, settled);
  EXPECT_NEAR(found, settled, 0.015);
  for (const double start : {0.1, 0.9})
    EXPECT_NEAR(share_in_stripes(votes, start), settled, 0.015 + kStays * std::abs(start - settled))
        << start;
  return found;
}

TEST(LineWalk, SettlesAtTheEtenduesOfLines) {
  expect_settled([](const LightLine&) { return 1.0; }, 0.5);
}

// Votes that succeed in a share of the cases thin lines out once. Twins: not at all, as for a chain
// reversible for W alone, or twice.
TEST(LineWalk, IsThinnedOutByTheVotesOnce) {
  constexpr double kShare = 0.3;
  const auto votes = [](const LightLine& l) { return in_stripe(l) ? kShare : 1.0; };
  const double found = expect_settled(votes, kShare / (1 + kShare));
  EXPECT_GT(std::abs(found - 0.5), 0.1);
  EXPECT_GT(std::abs(found - kShare * kShare / (1 + kShare * kShare)), 0.1);
}

}  // namespace tdpt::line_walk_test
