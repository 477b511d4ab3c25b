// The fine pass of the light grid: samples the lines that connect the two sides of a cut by
// etendue, without the distortion of the coarse pass.
//
// Method: Metropolis-Hastings; many reversible Markov chains over lines, run in parallel.
//
// l       a line between two surfaces on different sides of the cut
// dmu(l)  measure of lines, area times projected solid angle: etendue [m2 sr]
// w(x)    weight of the voxel at x; W(l) its integral along l
// f(a)    density of the angle a between a line and the next one [1/sr]
// A(l)    probability that a line is accepted: that only its end surfaces stop it (a probability
//         because of stochastic transparency), times that the votes around both ends hold
//         (ends_see_their_sides() of light_lines.h)
//
// A step samples a point x on l with density w(x)/W(l) and a direction with density f, and proposes
// the line l' through both, extended to the surfaces that it hits. The chain moves to l' if that
// connects the sides and is accepted by votes of its own; otherwise it stays.
//
// A line with a point on it is a point with a direction, dmu(l) ds = d3x dw, and the angle between
// l and l' is symmetric. So the flow from l to l',
//   pi(l) w(x)/W(l) f(a) A(l') with pi(l) = W(l) A(l) dmu(l),
// equals that from l' to l: the chain is reversible with stationary distribution pi; without the
// votes it would be W(l) dmu(l). Dividing by W leaves A(l) dmu(l): lines by etendue, thinned once
// by the votes, like the segments of the coarse pass, not once per step.
//
// Lines that bring the camera no light, such as those of windows at night, would take the place of
// others. With b(l) the light of a line [LightLine::share before it is shared out], b' its mean
// over the first lines, a move from l to l' is made with probability min(1, g(l')/g(l)), g = min(1,
// b/(kFaint b')): so lines have the density g(l) dmu(l). Bright lines are no denser than others,
// since an opening is found by all that passes it. A line stands for b/g.
//
// That is the limit. In practice the chains make only some moves, and w is re-estimated from their
// own lines, the last time half-way. Since no line is used twice, those whose W is below its lower
// quartile Q are all used: the result is A(l) min(1, W(l)/Q) dmu(l).
//
// f is cos/pi in half of the steps. In the others it is narrower, because few wide steps pass a
// long narrow opening. w = count^3, clamped at the fullest voxels, keeps x near the opening, where
// most lines through x connect the sides. The coarse counts cannot be used where there is geometry:
// leaks accumulate between the jambs of an opening, and a few bundles of light are as full along
// their whole length as in a small opening. So in the first steps, which are not reversible, x is
// the point of the line nearest to another line: all meet in the opening. The last wide try of each
// chain is kept as a probe: probes measure the support of portals.
#include "tools/lightgrid/lightgrid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

constexpr double kFull = 0.2;       // of the largest count: w is constant above it
constexpr double kNarrowest = 2e4;  // largest exponent of the cosine
// The walk ends after this many moves per chain on average, or after this many steps.
constexpr uint64_t kMoves = 4, kMostSteps = 48;
constexpr double kFaint = 0.02;  // of the mean light: lines with less are thinned
constexpr double kOffEnds = 1e-3;
constexpr uint64_t kMeetings = 4;  // number of first steps, with x where lines meet

// w of each voxel: its count cubed, clamped for the fullest so that the walk reaches the faint end
// of an opening as well as the bright one.
std::vector<double> weights_of(const std::vector<double>& count) {
  const double most = kFull * *std::max_element(count.begin(), count.end());
  std::vector<double> w(count.size());
  for (size_t i = 0; i < w.size(); ++i) w[i] = std::pow(std::min(count[i], most), 3);
  return w;
}

// Weight W of a line: w integrated along it [count^3 metres].
double weight_of(const LightGrid& grid, const std::vector<double>& w, const LightLine& line) {
  double sum = 0;
  walk_grid(grid, line.light, line.camera,
            [&](size_t voxel, double inside) { sum += w[voxel] * inside; });
  return sum;
}

// Samples a point on `line` [metres] in proportion to w; empty if w is 0 along it.
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

// W of all chains and its lower quartile, 0 if no line has any weight. A line is used with
// probability 1 / W in units of the quartile, but at most once.
struct ChainWeights {
  std::vector<double> of;
  double quartile = 0;
  bool empty() const { return quartile == 0; }
  double share(size_t i) const { return of[i] > 0 ? std::min(1.0, quartile / of[i]) : 0; }
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
  const auto quartile = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), quartile, sorted.end());
  weights.quartile = *quartile;
  return weights;
}

// The point on `line` nearest to `other` [metres]: all lines meet in the opening. `off_ends`:
// minimum distance from its ends [share of its length]: beyond the wall at an end may be the open
// sky.
Vec3d nearest_to(const LightLine& line, const LightLine& other, double off_ends) {
  const Vec3d d = line.camera - line.light, e = other.camera - other.light;
  const Vec3d between = line.light - other.light;
  const double dd = dot(d, d), de = dot(d, e), ee = dot(e, e);
  const double slant = dd * ee - de * de;
  const double t =
      slant > 1e-12 * dd * ee ? (de * dot(e, between) - ee * dot(d, between)) / slant : 0.5;
  return line.light + d * std::clamp(t, off_ends, 1 - off_ends);
}

// Counts of the target distribution, estimated from chains that have settled.
std::vector<double> recount(const LightGrid& grid, const std::vector<double>& w,
                            const std::vector<LightLine>& chain) {
  std::vector<double> count(w.size(), 0);
  const ChainWeights weights = weights_of(grid, w, chain);
  for (size_t i = 0; i < chain.size(); ++i)
    walk_grid(grid, chain[i].light, chain[i].camera,
              [&](size_t voxel, double) { count[voxel] += weights.share(i); });
  return count;
}

// Samples a direction about +z with density proportional to cos^exponent per solid angle.
Vec3d turned_from_axis(double u, double v, double exponent) {
  const double z = std::pow(v, 1 / (exponent + 1)), phi = 2 * std::numbers::pi * u;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// The state of each chain is a line.
class Chains {
 public:
  Chains(const Scene& scene, LineTracer& tracer, size_t c, const LightGrid& grid,
         const std::vector<uint32_t>& count, const std::vector<LightLine>& kept, size_t chains,
         uint64_t seed)
      : scene_(scene),
        tracer_(tracer),
        cut_(c),
        grid_(grid),
        seed_(seed),
        stream_(kChains.first + (uint64_t{c} << 32)),
        w_(weights_of({count.begin(), count.end()})),
        start_(kept),
        line_(chains),
        tries_(chains),
        wide_(chains),
        probe_(chains) {
    // Lines without weight, as between jambs, cannot move.
    std::erase_if(start_, [&](const LightLine& l) { return !(weight_of(grid_, w_, l) > 0); });
    if (start_.empty()) start_ = kept;
    double sum = 0;
    for (const LightLine& line : start_) sum += line.share;
    faint_ = kFaint * sum / static_cast<double>(std::max<size_t>(start_.size(), 1));
    std::vector<double> lit;
    for (const LightLine& line : start_) lit.push_back(lit_share(line));
    const AliasTable table(lit);
    for (size_t i = 0; i < chains; ++i) {
      Rng rng(seed, stream_, i, kMostSteps);
      line_[i] = start_[table.sample(rng.uniform())];
    }
  }

  void run() {
    const size_t chains = line_.size();
    bool recounted = false;
    const std::vector<double> ones(w_.size(), 1);
    for (uint32_t round = 0; round < kMostSteps && moves_ < kMoves * chains; ++round) {
      if (round == kMeetings) w_ = weights_of(recount(grid_, ones, line_));
      if (!recounted && (2 * moves_ >= kMoves * chains || 2 * round >= kMostSteps)) {
        // Re-estimates w: the distorted coarse counts would keep the chains away from regions that
        // they undersampled.
        w_ = weights_of(recount(grid_, w_, line_));
        recounted = true;
      }
      tbb::parallel_for(tbb::blocked_range<size_t>(0, chains, 256), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) propose(i, round);
      });
      tracer_.through(cut_, round, tries_, found_);
      for (size_t i = 0; i < chains; ++i) step(i, round);
    }
  }

  LineWalk result(size_t most) const {
    LineWalk walk;
    walk.tried = tried_, walk.joined = joined_;
    for (const std::optional<Probe>& p : probe_)
      if (p) walk.probes.push_back(*p);
    // The stationary distribution is the target times the chains' weight W: divide by it. Half of
    // the lines are dropped.
    const ChainWeights weights = weights_of(grid_, w_, line_);
    if (weights.empty()) {  // no line passes counted air, so all are equal
      walk.lines.assign(line_.begin(), line_.begin() + static_cast<std::ptrdiff_t>(most));
    } else {
      for (size_t i = 0; i < line_.size() && walk.lines.size() < most; ++i) {
        Rng rng(seed_, stream_, i, kMostSteps + 1);
        if (rng.uniform() < weights.share(i)) walk.lines.push_back(line_[i]);
      }
    }
    for (Probe& p : walk.probes) p.line.cut = static_cast<uint32_t>(cut_);
    for (LightLine& line : walk.lines)
      line.cut = static_cast<uint32_t>(cut_), line.share /= lit_share(line);
    return walk;
  }

 private:
  // g of a line; a little is left of the darkest, so that the walk moves where nothing is lit.
  double lit_share(const LightLine& line) const {
    return faint_ > 0 ? std::clamp(line.share / faint_, 1e-6, 1.0) : 1;
  }

  // A point on chain i and a direction; no direction if the line has no weight.
  void propose(size_t i, uint32_t round) {
    Rng rng(seed_, stream_, i, round);
    const double u = rng.uniform();
    const double v1 = rng.uniform();
    const double v2 = rng.uniform();
    const double sharp = rng.uniform();
    wide_[i] = sharp < 0.5;
    tries_[i] = {};
    const double off_ends = scene_.dome < scene_.triangles.size() ? kOffEnds : 0;
    const auto meeting = [&] {
      const auto n = start_.size();
      return std::min(n - 1, static_cast<size_t>(u * static_cast<double>(n)));
    };
    const std::optional<Vec3d> place = round < kMeetings
                                           ? nearest_to(line_[i], start_[meeting()], off_ends)
                                           : place_on(grid_, w_, line_[i], u);
    if (!place) return;
    const Onb<double> frame(normalize(line_[i].camera - line_[i].light));
    const double exponent = wide_[i] ? 1 : std::pow(kNarrowest, 2 * sharp - 1);
    tries_[i].place = Vec3f(scene_.frame.to_canonical(*place));
    tries_[i].direction = Vec3f(frame.to_world(turned_from_axis(v1, v2, exponent)));
  }

  // Moves chain i to its proposed line, or not.
  void step(size_t i, uint32_t round) {
    if (found_.fate[i] == LineFate::none) return;
    const bool joins = found_.fate[i] == LineFate::joins;
    const LightLine line = tracer_.in_metres(scene_, grid_, cut_, found_.ends[i]);
    if (joins) {
      const double ratio = lit_share(line) / lit_share(line_[i]);
      Rng rng(seed_, stream_, i, kMostSteps + 2 + round);
      const bool moves = ratio >= 1 || rng.uniform() < ratio;
      moves_ += moves;
      if (moves) line_[i] = line;
    }
    if (!wide_[i]) return;
    probe_[i] = Probe{line, joins};
    ++tried_;
    joined_ += joins;
  }

  const Scene& scene_;
  LineTracer& tracer_;
  const size_t cut_;
  const LightGrid& grid_;
  const uint64_t seed_, stream_;
  std::vector<double> w_;         // per voxel
  std::vector<LightLine> start_;  // from the coarse pass
  double faint_ = 0;              // light of a line below which it is thinned
  std::vector<LightLine> line_;   // per chain, as are the following
  std::vector<shader::LineTry> tries_;
  std::vector<uint8_t> wide_;  // whether the try is a probe of the portals' support
  std::vector<std::optional<Probe>> probe_;
  TracedLines found_;
  uint64_t moves_ = 0, tried_ = 0, joined_ = 0;
};

}  // namespace

LineWalk walk_among_lines(const Scene& scene, LineTracer& tracer, size_t c, const LightGrid& grid,
                          const std::vector<uint32_t>& count, const std::vector<LightLine>& kept,
                          size_t most, uint64_t seed) {
  Chains chains(scene, tracer, c, grid, count, kept, 2 * most, seed);
  chains.run();
  return chains.result(most);
}

}  // namespace tdpt
