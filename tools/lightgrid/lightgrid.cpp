// Measures where light passes through the air between the two sides of each cut: counts, directions
// and lines [section 4.2].
//
// Method: Monte Carlo, in two passes. Coarse, as in the paper: segments between pivot patches,
// tested for visibility and marched through the grid (3D DDA), in batches that double until the
// shape of the counts settles. This shows where the light passes, but patches and voxels blur it,
// and uniform points on patches distort it. Fine: the Markov chain over lines of line_walk.cpp,
// started from these segments. The user's own lines replace the segments and are kept; then only
// the probes of the fine pass are used.
#include "tools/lightgrid/lightgrid.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "tools/lightgrid/line_tables.h"

namespace tdpt {
namespace {

constexpr uint64_t kFirstBatch = 1 << 15;
constexpr double kAroundRooms = 0.1;   // of their longest side: allows for walls of this thickness
constexpr size_t kFewestKept = 2000;   // with fewer kept segments the counts never count as settled
constexpr double kHot = 0.25;          // of the largest count: voxels that are compared
constexpr uint64_t kBlock = 1 << 17;   // segments in memory at a time
constexpr size_t kMostKept = 1 << 20;  // coarse lines from which the fine pass starts
constexpr size_t kBytesOfVoxel = 100;  // the grid, its counters and the weights of the fine pass

// Number of lines through each voxel of air.
void read_counts(const LightGrid& grid, LineTracer& tracer, std::vector<uint32_t>& count) {
  tracer.counts(count);
  for (size_t i = 0; i < count.size(); ++i)
    if (!grid.air[i]) count[i] = 0;
}

// Half the sum of absolute differences between two normalised counts, over the hot voxels of the
// newer one.
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

}  // namespace

Extent box_of(const Scene& scene) {
  Extent box;
  const size_t surfaces = std::min<size_t>(scene.dome, scene.triangles.size());
  for (size_t t = 0; t < surfaces; ++t)
    for (const uint32_t v : scene.triangles[t].vertex) box.add(Vec3d(scene.positions[v]));
  return box;
}

Extent reach_of_cut(const Scene& scene, const CutFile& cut) {
  // With a sky, only the rooms: their borders contain all openings, and the landscape is far
  // larger.
  const bool sky = has_sky(cut);
  std::vector<Vec3d> places;
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const Patch& p = cut.patches[i];
    if (sky && cut.sides[i] == 0) continue;
    places.push_back(scene.frame.to_canonical(p.centre));
  }
  const Extent box = box_of(scene);
  const Extent reach = reach_of(places);
  if (reach.empty()) return box;
  // Plus a piece of the way by which light reaches the outermost rooms.
  if (sky) return reach.within(box).widened(Vec3d(kAroundRooms * max_component(reach.size())));
  return reach.within(box);
}

LightGrid empty_grid(const Scene& scene, const Extent& box, int resolution) {
  LightGrid grid;
  grid.scene_hash = scene.identity();
  const Vec3d size = box.size();
  const double voxel = max_component(size) / resolution;
  Vec3d corner = (box.low + box.high) * 0.5;
  size_t total = 1;
  for (int c = 0; c < 3; ++c) {
    const auto s = static_cast<size_t>(c);
    grid.dim[s] = std::max(1, static_cast<int>(std::ceil(size[c] / voxel - 1e-6)));
    corner[c] -= 0.5 * grid.dim[s] * voxel;
    total *= static_cast<size_t>(grid.dim[s]);
  }
  expect_memory(fmt::format("{} voxels (--resolution)", fmt::join(grid.dim, " x ")),
                total * kBytesOfVoxel);
  grid.origin = scene.frame.to_metres(corner);
  grid.voxel = voxel / scene.frame.scale;
  grid.count.assign(total, 0);
  grid.direction.assign(total, {});
  return grid;
}

namespace {

LightGrid no_light_grid(const Scene& scene, const std::string& reason) {
  LightGrid none;
  none.scene_hash = scene.identity();
  none.bottleneck = false;
  none.reason = reason;
  return none;
}

// Share of its camera's light that crosses cut `c`; 1 if unknown.
double carried_by(const CutFile& cut, size_t c) {
  if (cut.light.empty()) return 1;
  double sum = 0;
  for (const CutArc& a : cut.arcs)
    if (cut.crosses(a, c))
      sum += a.capacity * cut.light[a.from].brightness *
             cut.light[a.to].importance[cut.cuts[c].camera];
  return sum;
}

// Divides `light` among lines in proportion to what they were drawn with.
void share_out(double light, std::span<LightLine> lines) {
  double drawn = 0;
  for (const LightLine& line : lines) drawn += line.share;
  if (!(drawn > 0)) return;
  for (LightLine& line : lines) line.share *= light / drawn;
}

// Counts the light of the cuts of a scene in a grid.
struct LightCounter {
  const Scene& scene;
  const CutFile& cut;
  const LightGridOptions& options;
  const LightGridWatch& watch;
  LineTracer& tracer;
  LightGrid& grid;
  LightGridReport& report;
  std::vector<Vec3d> direction;   // sums over all cuts
  std::vector<uint32_t> count{};  // of the current cut

  // Both passes for cut `c`.
  void add_cut(size_t c) {
    count.assign(grid.count.size(), 0);
    PassStatistics& of_cut = report.cuts[c];
    const bool own = !options.own.empty();
    const std::vector<LightLine> kept = own ? own_pass(c, of_cut) : coarse_pass(c, of_cut);
    report.phases.done("coarse");
    if (of_cut.visible > 0)
      grid.cuts[c].kept = static_cast<double>(of_cut.kept) / static_cast<double>(of_cut.visible);
    if (kept.empty()) return;
    for (size_t i = 0; i < count.size(); ++i) grid.count[i] += static_cast<float>(count[i]);
    const LineWalk walk =
        walk_among_lines(scene, tracer, c, grid, count, kept, options.lines, options.seed);
    const size_t before = grid.lines.size();
    for (LightLine line : own ? kept : walk.lines)
      if (clip_to(grid, line)) grid.lines.push_back(line);
    const std::span lines = std::span(grid.lines).subspan(before);
    share_out(carried_by(cut, c), lines);
    for (Probe probe : walk.probes)
      if (clip_to(grid, probe.line)) grid.probes.push_back(probe);
    of_cut.lines = lines.size();
    of_cut.tried = walk.tried;
    of_cut.joined = walk.joined;
    report.phases.done("fine");
  }

  void set_directions() {
    for (size_t i = 0; i < grid.count.size(); ++i) {
      if (grid.count[i] == 0) continue;
      grid.direction[i] = Vec3f(direction[i] / static_cast<double>(grid.count[i]));
      report.fullest = std::max(report.fullest, grid.count[i]);
    }
  }

  // Samples segments between pivot patches of cut `c` until the counts settle; returns the first
  // kMostKept of those that connect the two sides. Sets count to this cut's counts; adds its lines
  // to direction, in air or not.
  std::vector<LightLine> coarse_pass(size_t c, PassStatistics& pass) {
    std::vector<LightLine> kept;
    TracedLines line;
    uint64_t summed = 0;
    tracer.clear();
    for (uint64_t batch = kFirstBatch; pass.drawn < options.samples; batch = pass.drawn) {
      const std::vector<uint32_t> before = count;
      const uint64_t end = pass.drawn + std::min(batch, options.samples - pass.drawn);
      while (pass.drawn < end && !report.stopped) {
        const uint64_t n = std::min(end - pass.drawn, kBlock);
        if (summed + n > LIGHT_MOST_SUMMED) tracer.take_directions(direction), summed = 0;
        tracer.between_pivots(c, static_cast<uint32_t>(pass.drawn), static_cast<uint32_t>(n), line);
        summed += n;
        for (size_t i = 0; i < n; ++i) {
          pass.visible += line.fate[i] != LineFate::none;
          if (line.fate[i] != LineFate::joins) continue;
          ++pass.kept;
          if (kept.size() < kMostKept)
            kept.push_back(tracer.in_metres(scene, grid, c, line.ends[i]));
        }
        pass.drawn += n;
        if (watch.progress) watch.progress(n);
        report.stopped = watch.stop && watch.stop();
      }
      ++pass.batches;
      read_counts(grid, tracer, count);
      pass.change = change_between(before, count);
      pass.settled = pass.kept >= kFewestKept && pass.change < options.tolerance;
      if (pass.settled || report.stopped) break;
    }
    tracer.take_directions(direction);
    return kept;
  }

  // The same for the user's lines: those of cut `c`, counted unchanged.
  std::vector<LightLine> own_pass(size_t c, PassStatistics& pass) {
    std::vector<LightLine> kept;
    for (LightLine line : options.own) {
      if (line.cut != c || !clip_to(grid, line)) continue;
      kept.push_back(line);
      walk_grid(grid, line.light, line.camera, [&](size_t voxel, double) {
        count[voxel] += grid.air[voxel];
        direction[voxel] += normalize(line.camera - line.light);
      });
    }
    pass.drawn = pass.visible = pass.kept = kept.size();
    pass.settled = true;
    pass.change = 0;
    return kept;
  }
};

}  // namespace

PassStatistics LightGridReport::all() const {
  PassStatistics sum;
  sum.settled = !cuts.empty();
  sum.change = cuts.empty() ? 1 : 0;
  for (const PassStatistics& of_cut : cuts) {
    sum.drawn += of_cut.drawn, sum.visible += of_cut.visible, sum.kept += of_cut.kept;
    sum.tried += of_cut.tried, sum.joined += of_cut.joined, sum.lines += of_cut.lines;
    if (of_cut.drawn == 0) continue;
    sum.settled = sum.settled && of_cut.settled;
    sum.change = std::max(sum.change, of_cut.change);
  }
  return sum;
}

LightGrid make_light_grid(const Scene& scene, const CutFile& cut, const std::string& cut_name,
                          const LightGridOptions& options, LightGridReport& report,
                          const LightGridWatch& watch, const MakeLineTracer& make_tracer) {
  check_made_from(scene, cut.scene_hash, cut_name);
  if (!cut.bottleneck)
    return no_light_grid(scene, cut.reason.empty() ? "the scene has no bottleneck" : cut.reason);
  if (scene.triangles.empty()) return no_light_grid(scene, "the scene has no triangles");

  LightGrid grid = empty_grid(scene, reach_of_cut(scene, cut), options.resolution);
  grid.walls = wall_directions(scene, grid);
  grid.panes = solid_panes(scene);
  mark_air(scene, grid);
  report.air = static_cast<size_t>(std::count(grid.air.begin(), grid.air.end(), 1));
  report.phases.done("air");
  const LineTables tables = make_line_tables(scene, cut, cut_name);
  report.phases.done("patches");
  const std::unique_ptr<LineTracer> tracer = make_tracer(scene, tables, grid, options.seed);
  report.phases.done("bvh");
  report.cuts.resize(cut.cuts.size());
  for (const Bottleneck& b : cut.cuts)
    grid.cuts.push_back({std::clamp(b.conductance, 0.0, 1.0), 0, b.camera});
  LightCounter counter{scene,   cut,  options, watch,
                       *tracer, grid, report,  std::vector<Vec3d>(grid.count.size())};
  for (size_t c = 0; c < cut.cuts.size() && !report.stopped; ++c)
    if (tables.cuts[c].count > 0 || !options.own.empty()) counter.add_cut(c);
  const PassStatistics all = report.all();
  if (all.drawn == 0)
    return no_light_grid(scene, options.own.empty() ? "no pair of the cut has any surface"
                                                    : "no line given lies in the grid");
  grid.flux_share =
      all.visible ? static_cast<double>(all.kept) / static_cast<double>(all.visible) : 0;
  if (grid.lines.empty()) {
    LightGrid none =
        no_light_grid(scene, "no segment between the pivot patches joins the two sides");
    none.flux_share = 0;
    return none;
  }
  counter.set_directions();
  return grid;
}

}  // namespace tdpt
