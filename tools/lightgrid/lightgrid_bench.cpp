// Segments between pivot patches per second that each back end samples, tests and counts, in one
// interleaved run:
//   lightgrid_bench [gpu[:WHICH]] [RESOLUTION] SCENE CUT [SCENE CUT ...]
// prints a table in Markdown, and on stderr the device and what becomes of the segments.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/process.h"
#include "libcommon/gpu/device.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/testing/scalar_lines.h"

namespace tdpt {
namespace {

constexpr int kRounds = 5;
constexpr double kLeastSeconds = 0.3;  // per round of one back end

struct Timed {
  std::string name;
  std::unique_ptr<LineTracer> tracer;
  uint32_t n = 1 << 13, next = 0;
  std::vector<double> per_second, per_cpu_second;  // segments
};

double now() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

// Doubles the number of segments until a round is long enough.
void one_round(Timed& t, bool keep) {
  TracedLines out;
  for (;;) {
    const double start = now(), cpu = cpu_seconds();
    t.tracer->between_pivots(0, t.next, t.n, out);
    const double seconds = now() - start, cpu_used = cpu_seconds() - cpu;
    t.next += t.n;
    if (!keep && seconds < kLeastSeconds && t.n < LIGHT_MOST_SUMMED / 2) {
      t.n *= 2;
      continue;
    }
    if (!keep) return;
    t.per_second.push_back(t.n / seconds);
    t.per_cpu_second.push_back(t.n / cpu_used);
    return;
  }
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(const std::string& scene_path, const std::string& cut_path, int resolution,
             const gpu::Device& device) {
  Scene scene = read_gltf(scene_path);
  open_glass(scene);
  const CutFile cut = read_cut(cut_path);
  const LightGrid grid = empty_grid(scene, resolution);
  const LineTables tables = make_line_tables(scene, cut, cut_path);
  if (tables.cuts.empty() || tables.cuts[0].count == 0)
    throw InputError(cut_path, "", "has no pairs to draw from");
  std::vector<Timed> all(3);
  all[0].name = "Embree + TBB";
  all[0].tracer = make_embree_lines(scene, tables, grid, 1);
  all[1].name = "scalar twin + TBB";
  all[1].tracer = make_scalar_lines(scene, tables, grid, 1);
  all[2].name = device.info().name;
  all[2].tracer = make_gpu_lines(device, scene, tables, grid, 1);
  for (Timed& t : all) one_round(t, false);
  std::vector<Vec3d> sums(grid.count.size());
  for (int round = 0; round < kRounds; ++round)
    for (Timed& t : all) {
      t.tracer->take_directions(sums);
      one_round(t, true);
    }
  const std::string name = scene_path.substr(scene_path.find_last_of('/') + 1);
  for (const Timed& t : all)
    fmt::print("| {} | {} | {}x{}x{} | {} | {:.3f} | {:.3f} | {:.2f} |\n", name,
               scene.triangles.size(), grid.dim[0], grid.dim[1], grid.dim[2], t.name,
               median(t.per_second) / 1e6, median(t.per_cpu_second) / 1e6,
               median(t.per_second) / median(all[0].per_second));
  TracedLines out;
  all[2].tracer->between_pivots(0, 0, all[2].n, out);
  uint32_t free = 0, joins = 0;
  for (const LineFate fate : out.fate)
    free += fate != LineFate::none, joins += fate == LineFate::joins;
  fmt::print(stderr, "{}: {:.0f} % of the segments are free, {:.0f} % join\n", name,
             100.0 * free / all[2].n, 100.0 * joins / all[2].n);
}

int run(std::vector<std::string> arguments) {
  std::string which;
  int resolution = 128;
  if (!arguments.empty() && arguments[0].rfind("gpu", 0) == 0) {
    if (arguments[0].size() > 4) which = arguments[0].substr(4);
    arguments.erase(arguments.begin());
  }
  if (!arguments.empty() && arguments[0].find_first_not_of("0123456789") == std::string::npos) {
    resolution = std::stoi(arguments[0]);
    arguments.erase(arguments.begin());
  }
  if (arguments.empty() || arguments.size() % 2 != 0)
    throw UsageError("usage: lightgrid_bench [gpu[:WHICH]] [RESOLUTION] SCENE CUT ...");
  const gpu::Device device = gpu::Device::open(which);
  fmt::print(stderr, "device: {} ({})\n", device.info().name, device.info().kind);
  fmt::print(
      "| scene | triangles | voxels | back end | million segments/s | per CPU second | of "
      "Embree |\n|---|---|---|---|---|---|---|\n");
  for (size_t i = 0; i < arguments.size(); i += 2)
    measure(arguments[i], arguments[i + 1], resolution, device);
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  try {
    return tdpt::run({argv + 1, argv + argc});
  } catch (const tdpt::Error& e) {
    fmt::print(stderr, "lightgrid_bench: {}\n", e.what());
    return static_cast<int>(e.code);
  }
}
