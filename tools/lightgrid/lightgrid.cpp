// Two passes. Coarse: segments between pivot patches, in batches that double until the shape of the
// counts settles. They show where the light passes, but patches and voxels blur it and uniform
// points on patches distort it.
//
// Fine: a walk among the lines that join the two sides, started from the coarse ones. A step takes
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
#include "tools/lightgrid/lightgrid.h"

#include <cmath>
#include <numbers>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/air.h"
#include "tools/lightgrid/light_lines.h"

namespace tdpt {
namespace {

constexpr uint64_t kCoarseStream = 0x6c67'0001, kFineStream = 0x6c67'0002;
constexpr uint64_t kFirstBatch = 1 << 15;
constexpr size_t kFewestKept = 2000;  // fewer never count as settled
constexpr double kHot = 0.25;         // of the largest count: voxels that are compared
constexpr size_t kChunk = 1 << 12;
constexpr uint64_t kBlock = 1 << 18;   // segments in memory at a time
constexpr size_t kMostKept = 1 << 20;  // coarse lines the fine pass starts from
// The fine pass ends when each chain has moved so often on average, or after so many steps.
constexpr double kFull = 0.2;       // of the largest count
constexpr double kNarrowest = 2e4;  // exponent of the cosine
constexpr uint64_t kMoves = 6, kMostSteps = 48;
constexpr uint64_t kMeetings = 4;  // first steps, at places where lines meet

void lay_out(const Scene& scene, int resolution, LightGrid& grid) {
  Vec3d low(INFINITY), high(-INFINITY);
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) {
      low = min(low, Vec3d(scene.positions[v]));
      high = max(high, Vec3d(scene.positions[v]));
    }
  const Vec3d size = high - low;
  const double voxel = max_component(size) / resolution;
  Vec3d corner = (low + high) * 0.5;
  size_t total = 1;
  for (int c = 0; c < 3; ++c) {
    const auto s = static_cast<size_t>(c);
    grid.dim[s] = std::max(1, static_cast<int>(std::ceil(size[c] / voxel - 1e-6)));
    corner[c] -= 0.5 * grid.dim[s] * voxel;
    total *= static_cast<size_t>(grid.dim[s]);
  }
  grid.origin = scene.frame.to_metres(corner);
  grid.voxel = voxel / scene.frame.scale;
  grid.count.assign(total, 0);
  grid.direction.assign(total, {});
}

// Counts and directions of all kept lines, summed in their order.
struct Tally {
  explicit Tally(size_t voxels) : count(voxels, 0), direction(voxels) {}
  std::vector<uint32_t> count;
  std::vector<Vec3d> direction;
  void add(const LightGrid& grid, const LightLine& line) {
    const Vec3d w = normalize(line.camera - line.light);
    walk_grid(grid, line.light, line.camera, [&](size_t voxel, double) {
      if (!grid.air[voxel]) return;
      ++count[voxel];
      direction[voxel] += w;
    });
  }
};

// Half the sum of differences between two normalised counts, over the hot voxels of the newer one.
double change_between(const std::vector<uint32_t>& before, const std::vector<uint32_t>& now) {
  const uint32_t most = *std::max_element(now.begin(), now.end());
  double sum_before = 0, sum_now = 0;
  const auto hot = [&](size_t i) { return now[i] > 0 && now[i] >= kHot * most; };
  for (size_t i = 0; i < now.size(); ++i)
    if (hot(i)) sum_before += before[i], sum_now += now[i];
  if (sum_before == 0 || sum_now == 0) return 1;
  double difference = 0;
  for (size_t i = 0; i < now.size(); ++i)
    if (hot(i)) difference += std::abs(before[i] / sum_before - now[i] / sum_now);
  return 0.5 * difference;
}

LightLine in_metres(const Scene& scene, const JoiningLine& l) {
  return {scene.frame.to_metres(l.light.position), scene.frame.to_metres(l.camera.position)};
}

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

// Random numbers of a pass through one cut.
uint64_t stream_of(uint64_t stream, size_t cut) {
  return stream + (uint64_t{cut} << 32);
}

struct CoarseReport {
  uint64_t drawn = 0, visible = 0, kept = 0;
  double change = 1;
  bool settled = false, stopped = false;
};

// Draws segments between pivot patches of cut `c` until the counts settle; returns those that join
// the two sides, the first kMostKept of them.
std::vector<LightLine> coarse_pass(const Scene& scene, const LightLines& lines, size_t c,
                                   const LightGrid& grid, const LightGridOptions& options,
                                   const LightGridWatch& watch, Tally& tally,
                                   CoarseReport& report) {
  std::vector<LightLine> kept;
  std::vector<JoiningLine> line;
  std::vector<LightLines::Fate> fate;
  for (uint64_t batch = kFirstBatch; report.drawn < options.samples; batch = report.drawn) {
    const std::vector<uint32_t> before = tally.count;
    const uint64_t end = report.drawn + std::min(batch, options.samples - report.drawn);
    while (report.drawn < end && !report.stopped) {
      const uint64_t first = report.drawn, n = std::min(end - first, kBlock);
      line.resize(n);
      fate.resize(n);
      tbb::parallel_for(tbb::blocked_range<uint64_t>(0, n, kChunk), [&](const auto& range) {
        for (uint64_t i = range.begin(); i < range.end(); ++i) {
          Rng rng(options.seed, stream_of(kCoarseStream, c), first + i);
          fate[i] = lines.between_pivots(c, rng, line[i]);
        }
        if (watch.progress) watch.progress(range.size());
      });
      for (uint64_t i = 0; i < n; ++i) {
        report.visible += fate[i] != LightLines::Fate::blocked;
        if (fate[i] != LightLines::Fate::kept) continue;
        ++report.kept;
        const LightLine found = in_metres(scene, line[i]);
        tally.add(grid, found);
        if (kept.size() < kMostKept) kept.push_back(found);
      }
      report.drawn += n;
      report.stopped = watch.stop && watch.stop();
    }
    report.change = change_between(before, tally.count);
    report.settled = report.kept >= kFewestKept && report.change < options.tolerance;
    if (report.settled || report.stopped) break;
  }
  return kept;
}

// A direction about +z with density proportional to cos^exponent per solid angle.
Vec3d turned_from_axis(double u, double v, double exponent) {
  const double z = std::pow(v, 1 / (exponent + 1)), phi = 2 * std::numbers::pi * u;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// The walk among the lines of cut `c`; adds to lines and probes of the grid.
void fine_pass(const Scene& scene, const LightLines& lines, size_t c,
               const std::vector<LightLine>& kept, const Tally& tally,
               const LightGridOptions& options, LightGrid& grid, LightGridReport& report) {
  // Every chain is a line; a step draws a line through a place on it and moves there if
  // it joins the two sides, too.
  const size_t chains = 2 * options.lines;
  std::vector<double> w = weights_of({tally.count.begin(), tally.count.end()});
  std::vector<LightLine> start = kept;  // lines without weight, as between jambs, cannot move
  std::erase_if(start, [&](const LightLine& l) { return !(weight_of(grid, w, l) > 0); });
  if (start.empty()) start = kept;
  std::vector<LightLine> chain(chains);
  for (size_t i = 0; i < chains; ++i) {
    Rng rng(options.seed, stream_of(kFineStream, c), i, kMostSteps);
    chain[i] = start[rng.below(static_cast<uint32_t>(start.size()))];
  }
  struct Step {
    LightLines::Through outcome;
    bool wide;
  };
  std::vector<Step> step(chains);
  std::vector<std::optional<Probe>> probe(chains);
  uint64_t moves = 0;
  bool recounted = false;
  const std::vector<double> ones(w.size(), 1);
  const auto pick_of = [](double u, size_t n) {
    return std::min(n - 1, static_cast<size_t>(u * static_cast<double>(n)));
  };
  for (uint64_t round = 0; round < kMostSteps && moves < kMoves * chains; ++round) {
    if (round == kMeetings) w = weights_of(recount(grid, ones, chain));
    if (!recounted && (2 * moves >= kMoves * chains || 2 * round >= kMostSteps)) {
      // What the coarse pass distorted would keep the chains from where it saw too little.
      w = weights_of(recount(grid, w, chain));
      recounted = true;
    }
    tbb::parallel_for(tbb::blocked_range<size_t>(0, chains, 256), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        Rng rng(options.seed, stream_of(kFineStream, c), i, round);
        const double u = rng.uniform(), v1 = rng.uniform(), v2 = rng.uniform();
        const double sharp = rng.uniform();
        step[i].outcome = LightLines::Through::unknown;
        const std::optional<Vec3d> place =
            round < kMeetings ? nearest_to(chain[i], start[pick_of(u, start.size())])
                              : place_on(grid, w, chain[i], u);
        if (!place) continue;
        const Onb<double> frame(normalize(chain[i].camera - chain[i].light));
        step[i].wide = sharp < 0.5;
        const double exponent = step[i].wide ? 1 : std::pow(kNarrowest, 2 * sharp - 1);
        JoiningLine line;
        step[i].outcome = lines.through(c, rng, scene.frame.to_canonical(*place),
                                        frame.to_world(turned_from_axis(v1, v2, exponent)), line);
        if (step[i].outcome == LightLines::Through::unknown) continue;
        const bool joins = step[i].outcome == LightLines::Through::joins;
        if (step[i].wide) probe[i] = Probe{in_metres(scene, line), joins};
        if (joins) chain[i] = in_metres(scene, line);
      }
    });
    for (const Step& s : step) {
      if (s.outcome == LightLines::Through::unknown) continue;
      moves += s.outcome == LightLines::Through::joins;
      if (!s.wide) continue;
      ++report.tried;
      report.joined += s.outcome == LightLines::Through::joins;
    }
  }
  for (std::optional<Probe>& p : probe) {
    if (!p) continue;
    p->line.cut = static_cast<uint32_t>(c);
    grid.probes.push_back(*p);
  }
  // The chains settle at the light's own distribution times their weight: take that out again. Half
  // of the lines go.
  const ChainWeights weights = weights_of(grid, w, chain);
  if (weights.empty()) {  // no line passes counted air, so none is better than another
    grid.lines.insert(grid.lines.end(), chain.begin(),
                      chain.begin() + static_cast<std::ptrdiff_t>(options.lines));
    return;
  }
  const size_t most = grid.lines.size() + options.lines;
  for (size_t i = 0; i < chains && grid.lines.size() < most; ++i) {
    Rng rng(options.seed, stream_of(kFineStream, c), i, kMostSteps + 1);
    if (rng.uniform() < weights.share(i)) grid.lines.push_back(chain[i]);
  }
}

}  // namespace

LightGrid make_light_grid(const Scene& scene, const CutFile& cut, const std::string& cut_name,
                          const LightGridOptions& options, LightGridReport& report,
                          const LightGridWatch& watch) {
  if (cut.scene_hash != scene.hash)
    throw InputError(display_name(cut_name), "",
                     "was made from another scene than " + display_name(scene.path));
  LightGrid grid;
  grid.scene_hash = scene.hash;
  const auto without = [&](const std::string& reason) {
    LightGrid none;
    none.scene_hash = scene.hash;
    none.bottleneck = false;
    none.reason = reason;
    return none;
  };
  if (!cut.bottleneck)
    return without(cut.reason.empty() ? "the scene has no bottleneck" : cut.reason);
  if (scene.triangles.empty()) return without("the scene has no triangles");

  lay_out(scene, options.resolution, grid);
  mark_air(scene, grid);
  report.air = static_cast<size_t>(std::count(grid.air.begin(), grid.air.end(), 1));
  report.phases.done("air");
  const Tracer tracer(scene);
  report.phases.done("bvh");
  const LightLines lines(scene, tracer, cut, cut_name);
  report.phases.done("patches");
  report.settled = true;
  report.change = 0;
  std::vector<Vec3d> direction(grid.count.size());
  for (const Bottleneck& b : cut.cuts)
    grid.cuts.push_back({std::clamp(b.conductance, 0.0, 1.0), 0});
  for (size_t c = 0; c < cut.cuts.size() && !report.stopped; ++c) {
    if (lines.empty(c)) continue;
    Tally tally(grid.count.size());
    CoarseReport coarse;
    const std::vector<LightLine> kept =
        coarse_pass(scene, lines, c, grid, options, watch, tally, coarse);
    report.phases.done("coarse");
    report.drawn += coarse.drawn;
    report.visible += coarse.visible;
    report.kept += coarse.kept;
    if (coarse.visible > 0)
      grid.cuts[c].kept = static_cast<double>(coarse.kept) / static_cast<double>(coarse.visible);
    report.stopped = coarse.stopped;
    report.settled = report.settled && coarse.settled;
    report.change = std::max(report.change, coarse.change);
    if (kept.empty()) continue;
    for (size_t i = 0; i < grid.count.size(); ++i) {
      grid.count[i] += static_cast<float>(tally.count[i]);
      direction[i] += tally.direction[i];
    }
    const size_t before = grid.lines.size();
    fine_pass(scene, lines, c, kept, tally, options, grid, report);
    report.phases.done("fine");
    for (size_t i = before; i < grid.lines.size(); ++i)
      grid.lines[i].cut = static_cast<uint32_t>(c);
  }
  if (report.drawn == 0) return without("no pair of the cut has any surface");
  grid.flux_share =
      report.visible ? static_cast<double>(report.kept) / static_cast<double>(report.visible) : 0;
  if (grid.lines.empty()) {
    LightGrid none = without("no segment between the pivot patches joins the two sides");
    none.flux_share = 0;
    return none;
  }
  for (size_t i = 0; i < grid.count.size(); ++i) {
    if (grid.count[i] == 0) continue;
    grid.direction[i] = Vec3f(direction[i] / static_cast<double>(grid.count[i]));
    report.fullest = std::max(report.fullest, grid.count[i]);
  }
  return grid;
}

}  // namespace tdpt
