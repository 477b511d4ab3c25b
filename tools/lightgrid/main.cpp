#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/phases.h"
#include "libcommon/base/progress.h"
#include "libcommon/base/signals.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"
#include "libcommon/gpu/device.h"
#include "tools/lightgrid/gpu_lines.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/preview.h"

namespace tdpt {
namespace {

std::string list_of_devices() {
  std::string text;
  const std::vector<gpu::DeviceInfo> devices = gpu::list_devices();
  for (size_t i = 0; i < devices.size(); ++i) {
    const gpu::DeviceInfo& d = devices[i];
    text += fmt::format("{}  {}  ({}{})\n", i, d.name, d.kind,
                        d.unfit.empty() ? "" : "; cannot be used: " + d.unfit);
  }
  return text;
}

struct NamedTracer {
  std::string name;  ///< of the device
  MakeLineTracer make;
};

// `device`: as --device names it. A GPU is opened at once: that there is none is told before work
// begins.
NamedTracer tracer_on(const std::string& device) {
  if (device == "cpu") return {device, make_embree_lines};
  if (device != "gpu" && device.rfind("gpu:", 0) != 0)
    throw UsageError("--device: '" + device + "' given, expected cpu, gpu or gpu:WHICH");
  const gpu::Device opened = gpu::Device::open(device == "gpu" ? "" : device.substr(4));
  return {opened.info().name,
          [opened](const Scene& scene, const LineTables& tables, const LightGrid& grid,
                   uint64_t seed) { return make_gpu_lines(opened, scene, tables, grid, seed); }};
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  cli::Options options("lightgrid",
                       "Counts the light between the two sides of a cut in the voxels of air it "
                       "passes.",
                       "The light grid (.vdb); default standard output");
  std::string scene_path, cut_path, device = "cpu", preview, debug_glb;
  int64_t resolution = 128, samples = 1 << 20, lines = 1 << 13;
  options.argument("scene", scene_path, "The scene, glTF 2.0 (.glb or .gltf)");
  options.argument("cut", cut_path, "Its minimum cut (.cut), as mincut writes it");
  options.option("--resolution", resolution, "N",
                 "Voxels along the longest side of the scene; default 128", 8, 512);
  options.option("--samples", samples, "N",
                 "Most segments drawn between pivot patches; default 1048576", 1, int64_t{1} << 32);
  options.option("--lines", lines, "N", "Most lines of light kept in the file; default 8192", 100,
                 1 << 22);
  options.option("--device", device, "cpu|gpu[:WHICH]",
                 "What traces the lines; default cpu. WHICH: number or part of the name of a "
                 "Vulkan device; else the best");
  options.instead("--list-devices", list_of_devices, "List the Vulkan devices and exit");
  options.side_output("--preview", preview,
                      "Write a PNG: the counts along the three axes of the grid");
  options.side_output("--debug-glb", debug_glb,
                      "Write the fullest voxels and some lines of light as glTF");
  return options.run_main(argc, argv, [&] {
    const cli::Common& common = options.common;
    const NamedTracer tracer = tracer_on(device);
    if (scene_path == "-" && cut_path == "-")
      throw UsageError("only one of the two inputs can come from standard input");
    catch_signals();
    if (device != "cpu") common.note("lines are traced by " + tracer.name + ".");
    LightGridReport report;
    Scene scene = read_gltf(scene_path);
    open_glass(scene);
    const CutFile cut = read_cut(cut_path);
    LightGridOptions how;
    how.resolution = static_cast<int>(resolution);
    how.seed = common.seed;
    how.samples = static_cast<uint64_t>(samples);
    how.lines = static_cast<size_t>(lines);
    LightGrid grid;
    report.phases.done("load");
    {
      Progress progress("tracing", "segments", how.samples, common.quiet);
      grid =
          make_light_grid(scene, cut, cut_path, how, report,
                          {[&](uint64_t n) { progress.advance(n); }, stop_requested}, tracer.make);
    }
    grid.provenance =
        common.provenance({{scene_path, scene.hash, {}}, {cut_path, cut.hash, cut.provenance}});
    if (!grid.bottleneck) {
      common.note("no light grid: " + grid.reason + ".");
    } else {
      common.note(
          fmt::format("{} of {} segments are visible, {} of these join the two sides; the "
                      "counts {} (change {:.1f} %).",
                      report.visible, report.drawn, report.kept,
                      report.settled ? "have settled"
                                     : "had not settled when the budget "
                                       "was spent",
                      100 * report.change));
      common.note(
          fmt::format("{} lines kept; of {} lines drawn through the light {} join the "
                      "two sides.",
                      grid.lines.size(), report.tried, report.joined));
    }
    write_output(common.output, light_grid_bytes(grid));
    report.phases.done("write");
    if (!preview.empty()) write_output(preview, grid_preview(grid, scene_path));
    if (!debug_glb.empty()) write_output(debug_glb, grid_debug_glb(grid));
    if (!(preview.empty() && debug_glb.empty())) report.phases.done("pictures");
    common.summary(nlohmann::json{{"bottleneck", grid.bottleneck},
                                  {"reason", grid.reason},
                                  {"drawn", report.drawn},
                                  {"visible", report.visible},
                                  {"kept", report.kept},
                                  {"settled", report.settled},
                                  {"change", report.change},
                                  {"tried", report.tried},
                                  {"joined", report.joined},
                                  {"lines", grid.lines.size()},
                                  {"voxels", grid.dim},
                                  {"air", report.air},
                                  {"voxel", grid.voxel},
                                  {"fullest", report.fullest},
                                  {"phases", report.phases},
                                  {"device", tracer.name},
                                  {"cpu_seconds", cpu_seconds()},
                                  {"peak_bytes", peak_memory()}}
                       .dump());
    if (!report.stopped) return 0;
    common.warn("stopped by a signal; the grid holds what was drawn until then");
    return static_cast<int>(Exit::interrupted);
  });
}
