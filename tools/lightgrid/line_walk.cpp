// The walk starts from the coarse lines. A step takes
// a place x on the line l with density w(x)/W(l), W(l) = integral of w along l, and a direction
// with density cos/pi of the angle to l, or, in half of the steps, nearer to l: through long narrow
// openings few others pass; it moves to the line through both if that joins the sides, and stays
// otherwise. Two lines that meet at x see each other under the same angle, so the walk is
// reversible with respect to W(l) times the measure of lines (area times projected solid angle):
// that is where it settles, whatever the coarse pass distorted. Dividing by W leaves the light's
// own distribution. w = count^3, but for the fullest voxels, keeps x near the opening, where most
// lines through x join the sides. The coarse counts are of no use where there is geometry, since
// leaks pile up between the jambs of an opening, and a few bundles of light are as full along their
// whole length as in a small opening. So in the first steps x is where the line comes nearest to
// another: all meet in the opening. Then the counts are taken from the walk's own lines, and once
// more half-way. The last wide try of each chain is kept as a probe: they tell the portals'
// support.
#include "tools/lightgrid/line_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace {

constexpr uint64_t kFineStream = 0x6c67'0002;
constexpr double kFull = 0.2;       // of the largest count
constexpr double kNarrowest = 2e4;  // exponent of the cosine
// The walk ends when each chain has moved so often on average, or after so many steps.
constexpr uint64_t kMoves = 6, kMostSteps = 48;
constexpr uint64_t kMeetings = 4;  // first steps, at places where lines meet

// w of each voxel: its count to the third power; the fullest are all alike, so that the walk goes
// to the faint end of an opening as well as to the bright one.
std::vector<double> weights_of(const std::vector<double>& count) {
  const double most = kFull * *std::max_element(count.begin(), count.end());
  std::vector<double> w(count.size());
  for (size_t i = 0; i < w.size(); ++i) w[i] = std::pow(std::min(count[i], most), 3);
  return w;
}

// Weight of a line: w integrated along it [1/metres].
double weight_of(const LightGrid& grid, const std::vector<double>& w, const LightLine& line) {
  double sum = 0;
  walk_grid(grid, line.light, line.camera,
            [&](size_t voxel, double inside) { sum += w[voxel] * inside; });
  return sum;
}

// A place on `line` [metres], in proportion to w; nothing where the line has none.
std::optional<Vec3d> place_on(const LightGrid& grid, const std::vector<double>& w,
                              const LightLine& line, double u) {
  double left = u * weight_of(grid, w, line), walked = 0, at = -1;
  walk_grid(grid, line.light, line.camera, [&](size_t voxel, double inside) {
    const double here = w[voxel] * inside;
    if (left >= 0 && here > 0) at = walked + inside * std::min(1.0, left / here);
    left -= here;
    walked += inside;
  });
  if (at < 0) return {};
  return line.light + normalize(line.camera - line.light) * at;
}

// Weights of chains, and the quarter of them: lines are taken in proportion to 1 / weight, but none
// for more than one of the quarter's. Both empty when no line has any weight.
struct ChainWeights {
  std::vector<double> of;
  double quarter = 0;
  bool empty() const { return quarter == 0; }
  double share(size_t i) const { return of[i] > 0 ? std::min(1.0, quarter / of[i]) : 0; }
};

ChainWeights weights_of(const LightGrid& grid, const std::vector<double>& w,
                        const std::vector<LightLine>& chain) {
  ChainWeights weights;
  weights.of.resize(chain.size());
  tbb::parallel_for(size_t{0}, chain.size(),
                    [&](size_t i) { weights.of[i] = weight_of(grid, w, chain[i]); });
  std::vector<double> sorted = weights.of;
  std::erase(sorted, 0.0);
  if (sorted.empty()) return weights;
  const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quarter, sorted.end());
  weights.quarter = *quarter;
  return weights;
}

// The place on `line` nearest to `other` [metres]: all lines meet in the opening.
Vec3d nearest_to(const LightLine& line, const LightLine& other) {
  const Vec3d d = line.camera - line.light, e = other.camera - other.light;
  const Vec3d between = line.light - other.light;
  const double dd = dot(d, d), de = dot(d, e), ee = dot(e, e);
  const double slant = dd * ee - de * de;
  const double t =
      slant > 1e-12 * dd * ee ? (de * dot(e, between) - ee * dot(d, between)) / slant : 0.5;
  return line.light + d * std::clamp(t, 0.0, 1.0);
}

// Counts of the light's own distribution, from chains that have settled.
std::vector<double> recount(const LightGrid& grid, const std::vector<double>& w,
                            const std::vector<LightLine>& chain) {
  std::vector<double> count(w.size(), 0);
  const ChainWeights weights = weights_of(grid, w, chain);
  for (size_t i = 0; i < chain.size(); ++i)
    walk_grid(grid, chain[i].light, chain[i].camera,
              [&](size_t voxel, double) { count[voxel] += weights.share(i); });
  return count;
}

// A direction about +z with density proportional to cos^exponent per solid angle.
Vec3d turned_from_axis(double u, double v, double exponent) {
  const double z = std::pow(v, 1 / (exponent + 1)), phi = 2 * std::numbers::pi * u;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace

LineWalk walk_among_lines(const Scene& scene, LineTracer& tracer, size_t c, const LightGrid& grid,
                          const std::vector<uint32_t>& count, const std::vector<LightLine>& kept,
                          size_t most, uint64_t seed) {
  // Every chain is a line; a step draws a line through a place on it and moves there if
  // it joins the two sides, too.
  LineWalk walk;
  const uint64_t stream = kFineStream + (uint64_t{c} << 32);
  const size_t chains = 2 * most;
  std::vector<double> w = weights_of({count.begin(), count.end()});
  std::vector<LightLine> start = kept;  // lines without weight, as between jambs, cannot move
  std::erase_if(start, [&](const LightLine& l) { return !(weight_of(grid, w, l) > 0); });
  if (start.empty()) start = kept;
  std::vector<LightLine> chain(chains);
  for (size_t i = 0; i < chains; ++i) {
    Rng rng(seed, stream, i, kMostSteps);
    chain[i] = start[rng.below(static_cast<uint32_t>(start.size()))];
  }
  std::vector<shader::LineTry> tries(chains);
  std::vector<uint8_t> wide(chains);
  TracedLines found;
  std::vector<std::optional<Probe>> probe(chains);
  uint64_t moves = 0;
  bool recounted = false;
  const std::vector<double> ones(w.size(), 1);
  const auto pick_of = [](double u, size_t n) {
    return std::min(n - 1, static_cast<size_t>(u * static_cast<double>(n)));
  };
  for (uint32_t round = 0; round < kMostSteps && moves < kMoves * chains; ++round) {
    if (round == kMeetings) w = weights_of(recount(grid, ones, chain));
    if (!recounted && (2 * moves >= kMoves * chains || 2 * round >= kMostSteps)) {
      // What the coarse pass distorted would keep the chains from where it saw too little.
      w = weights_of(recount(grid, w, chain));
      recounted = true;
    }
    tbb::parallel_for(tbb::blocked_range<size_t>(0, chains, 256), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        Rng rng(seed, stream, i, round);
        const double u = rng.uniform(), v1 = rng.uniform(), v2 = rng.uniform();
        const double sharp = rng.uniform();
        wide[i] = sharp < 0.5;
        tries[i] = {};
        const std::optional<Vec3d> place =
            round < kMeetings ? nearest_to(chain[i], start[pick_of(u, start.size())])
                              : place_on(grid, w, chain[i], u);
        if (!place) continue;
        const Onb<double> frame(normalize(chain[i].camera - chain[i].light));
        const double exponent = wide[i] ? 1 : std::pow(kNarrowest, 2 * sharp - 1);
        tries[i].place = Vec3f(scene.frame.to_canonical(*place));
        tries[i].direction = Vec3f(frame.to_world(turned_from_axis(v1, v2, exponent)));
      }
    });
    tracer.through(c, round, tries, found);
    for (size_t i = 0; i < chains; ++i) {
      if (found.fate[i] == LineFate::none) continue;
      const bool joins = found.fate[i] == LineFate::joins;
      const LightLine line = in_metres(scene, found.ends[i]);
      moves += joins;
      if (joins) chain[i] = line;
      if (!wide[i]) continue;
      probe[i] = Probe{line, joins};
      ++walk.tried;
      walk.joined += joins;
    }
  }
  for (std::optional<Probe>& p : probe) {
    if (!p) continue;
    p->line.cut = static_cast<uint32_t>(c);
    walk.probes.push_back(*p);
  }
  // The chains settle at the light's own distribution times their weight: take that out again. Half
  // of the lines go.
  const ChainWeights weights = weights_of(grid, w, chain);
  if (weights.empty()) {  // no line passes counted air, so none is better than another
    walk.lines.assign(chain.begin(), chain.begin() + static_cast<std::ptrdiff_t>(most));
  } else {
    for (size_t i = 0; i < chains && walk.lines.size() < most; ++i) {
      Rng rng(seed, stream, i, kMostSteps + 1);
      if (rng.uniform() < weights.share(i)) walk.lines.push_back(chain[i]);
    }
  }
  for (LightLine& line : walk.lines) line.cut = static_cast<uint32_t>(c);
  return walk;
}

}  // namespace tdpt
