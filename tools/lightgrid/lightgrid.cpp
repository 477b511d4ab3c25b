// Two passes. Coarse: segments between pivot patches, in batches that double until the shape of the
// counts settles. They show where the light passes, but patches and voxels blur it and uniform
// points on patches distort it. The fine pass is that of line_walk.h.
#include "tools/lightgrid/lightgrid.h"

#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/air.h"
#include "tools/lightgrid/light_lines.h"
#include "tools/lightgrid/line_walk.h"

namespace tdpt {
namespace {

constexpr uint64_t kCoarseStream = 0x6c67'0001;
constexpr uint64_t kFirstBatch = 1 << 15;
constexpr size_t kFewestKept = 2000;  // fewer never count as settled
constexpr double kHot = 0.25;         // of the largest count: voxels that are compared
constexpr size_t kChunk = 1 << 12;
constexpr uint64_t kBlock = 1 << 18;   // segments in memory at a time
constexpr size_t kMostKept = 1 << 20;  // coarse lines the fine pass starts from
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
    const LineWalk walk =
        walk_among_lines(scene, lines, c, grid, tally.count, kept, options.lines, options.seed);
    grid.lines.insert(grid.lines.end(), walk.lines.begin(), walk.lines.end());
    grid.probes.insert(grid.probes.end(), walk.probes.begin(), walk.probes.end());
    report.tried += walk.tried;
    report.joined += walk.joined;
    report.phases.done("fine");
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
