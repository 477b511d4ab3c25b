// Two passes. Coarse: segments between pivot patches, in batches that double until the shape of the
// counts settles. Fine: lines in cosine-distributed directions through the fullest place of each
// coarse line. The fine lines follow the light's own distribution (area times projected solid
// angle), are exact where voxels are not, and tell how many of all lines through a voxel join the
// two sides.
#include "tools/lightgrid/lightgrid.h"

#include <cmath>

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

// A random place on `line` within the fullest voxel that it passes.
Vec3d fullest_place(const LightGrid& grid, const LightLine& line, double u) {
  double walked = 0, at = 0;
  float most = -1;
  walk_grid(grid, line.light, line.camera, [&](size_t voxel, double inside) {
    if (grid.count[voxel] > most) {
      most = grid.count[voxel];
      at = walked + u * inside;
    }
    walked += inside;
  });
  return line.light + normalize(line.camera - line.light) * at;
}

}  // namespace

LightGrid make_light_grid(const Scene& scene, const CutFile& cut, const std::string& cut_name,
                          const LightGridOptions& options, LightGridReport& report,
                          const std::function<void(uint64_t)>& progress) {
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
  const Tracer tracer(scene);
  const LightLines lines(scene, tracer, cut, cut_name);
  if (lines.empty()) return without("no pair of the cut has any surface");

  // Coarse pass.
  const auto metres = [&](const JoiningLine& l) {
    return LightLine{scene.frame.to_metres(l.light.position),
                     scene.frame.to_metres(l.camera.position)};
  };
  Tally tally(grid.count.size());
  std::vector<LightLine> kept;
  for (uint64_t batch = kFirstBatch; report.drawn < options.samples; batch = report.drawn) {
    const uint64_t first = report.drawn, n = std::min(batch, options.samples - first);
    std::vector<JoiningLine> line(n);
    std::vector<LightLines::Fate> fate(n);
    tbb::parallel_for(tbb::blocked_range<uint64_t>(0, n, kChunk), [&](const auto& range) {
      for (uint64_t i = range.begin(); i < range.end(); ++i) {
        Rng rng(options.seed, kCoarseStream, first + i);
        fate[i] = lines.between_pivots(rng, line[i]);
      }
      if (progress) progress(range.size());
    });
    const std::vector<uint32_t> before = tally.count;
    for (uint64_t i = 0; i < n; ++i) {
      report.visible += fate[i] != LightLines::Fate::blocked;
      if (fate[i] != LightLines::Fate::kept) continue;
      kept.push_back(metres(line[i]));
      tally.add(grid, kept.back());
    }
    report.drawn += n;
    report.change = change_between(before, tally.count);
    if (kept.size() >= kFewestKept && report.change < options.tolerance) {
      report.settled = true;
      break;
    }
  }
  report.kept = kept.size();
  grid.flux_share = report.visible ? static_cast<double>(report.kept) / report.visible : 0;
  if (kept.empty()) {
    LightGrid none = without("no segment between the pivot patches joins the two sides");
    none.flux_share = 0;
    return none;
  }
  for (size_t i = 0; i < grid.count.size(); ++i) {
    if (tally.count[i] == 0) continue;
    grid.count[i] = static_cast<float>(tally.count[i]);
    grid.direction[i] = Vec3f(tally.direction[i] / tally.count[i]);
    report.fullest = std::max(report.fullest, grid.count[i]);
  }

  // Fine pass.
  grid.tried.assign(grid.count.size(), 0);
  grid.joined.assign(grid.count.size(), 0);
  const size_t trials = 4 * options.lines;
  constexpr size_t kRound = 1 << 13;
  for (size_t first = 0; first < trials && grid.lines.size() < options.lines; first += kRound) {
    std::vector<JoiningLine> line(kRound);
    std::vector<LightLines::Through> outcome(kRound);
    std::vector<size_t> voxel(kRound);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, kRound, 256), [&](const auto& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        Rng rng(options.seed, kFineStream, first + i);
        const LightLine& base = kept[rng.below(static_cast<uint32_t>(kept.size()))];
        const double u = rng.uniform(), r = rng.uniform(), phi = rng.uniform();
        const Vec3d on_line = fullest_place(grid, base, u);
        const Onb<double> frame(normalize(base.camera - base.light));
        // Up to a voxel aside, so that places between the coarse lines are reached, too.
        const Vec3d disc = cosine_hemisphere(phi, r);
        Vec3d place = on_line + (frame.x * disc.x + frame.y * disc.y) * grid.voxel;
        if (!tracer.visible({scene.frame.to_canonical(on_line)}, {scene.frame.to_canonical(place)}))
          place = on_line;
        const double v1 = rng.uniform(), v2 = rng.uniform();
        const Vec3d w = frame.to_world(cosine_hemisphere(v1, v2));
        outcome[i] = lines.through(rng, scene.frame.to_canonical(place), w, line[i]);
        const Vec3d p = (place - grid.origin) / grid.voxel;
        std::array<int, 3> at;
        for (int c = 0; c < 3; ++c) {
          const auto s = static_cast<size_t>(c);
          at[s] = std::clamp(static_cast<int>(std::floor(p[c])), 0, grid.dim[s] - 1);
        }
        voxel[i] = grid.index(at[0], at[1], at[2]);
      }
    });
    for (size_t i = 0; i < kRound; ++i) {
      if (outcome[i] == LightLines::Through::unknown) continue;
      ++grid.tried[voxel[i]];
      ++report.tried;
      if (outcome[i] != LightLines::Through::joins) continue;
      ++grid.joined[voxel[i]];
      ++report.joined;
      if (grid.lines.size() < options.lines) grid.lines.push_back(metres(line[i]));
    }
  }
  // Too few fine lines to speak for themselves: the coarse ones join in.
  if (grid.lines.size() < kFewestKept)
    for (size_t i = 0; i < kept.size() && grid.lines.size() < options.lines; ++i)
      grid.lines.push_back(kept[i]);
  return grid;
}

}  // namespace tdpt
