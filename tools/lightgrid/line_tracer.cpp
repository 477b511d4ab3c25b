#include "tools/lightgrid/line_tracer.h"

#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/line_kernel.h"

namespace tdpt {
namespace {

shader::LightParameters common_of(const Scene& scene, const LineTables& tables,
                                  const LightGrid& grid, uint64_t seed) {
  shader::LightParameters p{};
  p.grid_corner = Vec3f(scene.frame.to_canonical(grid.origin));
  p.voxels_per_unit = static_cast<float>(1 / (grid.voxel * scene.frame.scale));
  p.dim = {grid.dim[0], grid.dim[1], grid.dim[2]};
  p.cell_corner = tables.cell_corner;
  p.cells_per_unit = tables.cells_per_unit;
  p.seed = seed;
  p.levels = tables.levels;
  p.first_sky_face = tables.first_sky_face;
  return p;
}

// For looking up patches alone.
struct NoRays {
  bool segment_blocked(const Vec3f&, const Vec3f&, uint32_t) const { return false; }
  bool first_hit(const Vec3f&, const Vec3f&, uint32_t, shader::SurfaceHit&) const { return false; }
};

}  // namespace

bool clip_to(const LightGrid& grid, LightLine& line) {
  const Vec3d d = line.camera - line.light;
  double enter = 0, leave = 1;
  for (int c = 0; c < 3; ++c) {
    const double low = grid.origin[c];
    const double high = low + grid.voxel * grid.dim[static_cast<size_t>(c)];
    if (d[c] == 0) {
      if (line.light[c] < low || line.light[c] > high) return false;
      continue;
    }
    const double t0 = (low - line.light[c]) / d[c], t1 = (high - line.light[c]) / d[c];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  if (!(enter < leave)) return false;
  if (leave < 1) line.camera = line.light + d * leave;
  if (enter > 0) line.light = line.light + d * enter;
  return true;
}

uint32_t LineTracer::patch_at(uint32_t face, const shader::vec3& place) const {
  static const NoRays none;
  static VoxelSums sums(0);
  uint32_t index;
  return shader::LineKernel(none, tables_, common_, sums).cell_at(face, place, index)
             ? tables_.patch_of_cell[index]
             : UINT32_MAX;
}

LightLine LineTracer::in_metres(const Scene& scene, const LightGrid& grid, size_t c,
                                const shader::LineEnds& ends) const {
  LightLine line{scene.frame.to_metres(Vec3d(ends.light)),
                 scene.frame.to_metres(Vec3d(ends.camera))};
  line.share = 1;
  if (!tables_.light.empty()) {
    const uint32_t from = patch_at(ends.light_face, ends.light);
    const uint32_t to = patch_at(ends.camera_face, ends.camera);
    const bool known = from != UINT32_MAX && to != UINT32_MAX;
    line.share = known ? tables_.light[from].brightness *
                             tables_.light[to].importance[tables_.cuts[c].camera]
                       : 0;
  }
  if (std::max(ends.light_face, ends.camera_face) / 2 >= scene.dome) clip_to(grid, line);
  return line;
}

LineTracer::LineTracer(const Scene& scene, const LineTables& tables, const LightGrid& grid,
                       uint64_t seed)
    : tables_(tables), common_(common_of(scene, tables, grid, seed)) {}

shader::LightParameters LineTracer::parameters(const Streams& streams, size_t c, uint32_t n) const {
  shader::LightParameters p = common_;
  p.stream = static_cast<uint32_t>(streams.first | c);
  p.cut = static_cast<uint32_t>(c);
  p.first_arc = tables_.cuts[c].first;
  p.arcs = tables_.cuts[c].count;
  p.count = n;
  return p;
}

void LineTracer::between_pivots(size_t c, uint32_t first, uint32_t n, TracedLines& out) {
  out.ends.resize(n);
  out.fate.resize(n);
  shader::LightParameters p = parameters(kPivotLines, c, n);
  p.first = first;
  trace_segments(p, out);
}

void LineTracer::through(size_t c, uint32_t round, std::span<const shader::LineTry> tries,
                         TracedLines& out) {
  out.ends.resize(tries.size());
  out.fate.resize(tries.size());
  shader::LightParameters p = parameters(kTriedLines, c, static_cast<uint32_t>(tries.size()));
  p.round = round;
  trace_tries(p, tries, out);
}

void VoxelSums::clear() {
  std::fill(sums_.begin(), sums_.end(), Sum());
}

void VoxelSums::counts(std::vector<uint32_t>& count) const {
  count.resize(sums_.size());
  for (size_t i = 0; i < sums_.size(); ++i)
    count[i] = static_cast<uint32_t>(high(sums_[i].count_x));
}

void VoxelSums::take_directions(std::vector<Vec3d>& sum) {
  for (size_t i = 0; i < sums_.size(); ++i) {
    Sum& s = sums_[i];
    sum[i] += Vec3d(s.direction()) * (1 / double{LIGHT_DIRECTION_UNITS});
    s = {packed(high(s.count_x), 0), 0};
  }
}

std::unique_ptr<LineTracer> make_embree_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed) {
  return std::make_unique<CpuLines<Tracer>>(scene, tables, grid, seed);
}

}  // namespace tdpt
