// lightgrid: counts the light between the two sides of a cut in the voxels of air.
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/progress.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/draw/drawing.h"
#include "libcommon/formats/light_tables.h"
#include "libcommon/gpu/device_options.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/options/sky_options.h"
#include "libcommon/scene/uses.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/line_tables.h"
#include "tools/lightgrid/preview.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "lightgrid",
    "Counts the light between the two sides of a cut in the voxels of air it "
    "passes.",
    "The light grid (.vdb); default standard output",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit};

// What they are worth, doc/efficiency.md.
constexpr cli::ByQuality<int64_t> kResolution{64, 128, 256}, kLines{2048, 8192, 16384};

constexpr double kBesideBox = 0.1;  // of its longest side

struct Arguments {
  std::string scene, cut, lines_from, device, preview, debug_glb;
  SkyArguments sky;
  Pose pose;
  int64_t resolution = 0, lines = 0;
  bool z_up = false;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.argument("scene", a.scene, "The scene, glTF 2.0 (.glb or .gltf)");
  options.argument("cut", a.cut, "Its minimum cut (.cut), as mincut writes it");
  options.input("--lines-from", a.lines_from, "FILE",
                "Take lines of one's own from a table (.csv) in place of drawing them");
  options.side_output(
      "--preview", a.preview,
      "Write a picture (.png, .svg, .pdf): the counts along the three axes of the grid");
  options.side_output("--debug-glb", a.debug_glb,
                      "Write the fullest voxels and some lines of light as glTF");
  options.flag("--z-up", a.z_up, "Turn the grid for viewers whose up is +Z, as Blender");
  options.part(cli::Part::effort);
  options.quality();
  options.option("--resolution,--set resolution", a.resolution, kResolution, "N",
                 "Voxels along the longest side of the grid", 8, 512);
  options.option("--set lines", a.lines, kLines, "N", "Most lines of light kept in the file", 100,
                 1 << 22);
  declare_device_options(options, a.device, "What traces the lines");
  declare_pose_options(options, a.pose);
  declare_sky_options(options, a.sky);
}

struct NamedTracer {
  std::string name;   ///< of the device
  std::string words;  ///< with what is to be said of it
  MakeLineTracer make;
};

// `device`: as --device names it.
NamedTracer tracer_on(const std::string& device) {
  const std::optional<gpu::Device> opened = device_asked(device);
  if (!opened) return {device, device, make_embree_lines};
  return {opened->info().name, words_of(opened->info()),
          [opened](const Scene& scene, const LineTables& tables, const LightGrid& grid,
                   uint64_t seed) { return make_gpu_lines(*opened, scene, tables, grid, seed); }};
}

struct Loaded {
  Scene scene;
  CutFile cut;
  std::vector<LightLine> lines;  ///< one's own
  std::vector<cli::Common::Input> files;
};

// One's own lines: of cuts that there are and, unless they come from a sky, with ends about the box
// of the scene. What draws them may know its patches and not their borders; other units show.
void load_lines(const std::string& path, Loaded& in) {
  LineLimits limits;
  limits.cuts = in.cut.cuts.size();
  const Extent box = box_of(in.scene);
  const Extent around = box.widened(Vec3d(kBesideBox * max_component(box.size())));
  if (!has_sky(in.cut)) {
    limits.low = in.scene.frame.to_metres(around.low);
    limits.high = in.scene.frame.to_metres(around.high);
  }
  const LightGrid table = read_light_lines(path, limits);
  if (!table.scene_hash.empty()) check_made_from(in.scene, table.scene_hash, path);
  in.files.push_back({path, table.hash, table.provenance});
  in.lines = table.lines;
}

Loaded load(const Arguments& a, const cli::Common& common) {
  Loaded in;
  in.scene = read_gltf(a.scene, a.pose);
  common.also_read(in.scene.files);
  open_glass(in.scene);
  in.files.push_back({a.scene, in.scene.hash, {}});
  add_sky(in.scene, a.sky, common, in.files);
  in.cut = read_cut(a.cut);
  in.files.push_back({a.cut, in.cut.hash, in.cut.provenance});
  if (has_sky(in.cut)) add_sky_dome(in.scene);
  if (!a.lines_from.empty()) load_lines(a.lines_from, in);
  return in;
}

LightGridOptions options_of(const Arguments& a, const cli::Common& common, const Loaded& in) {
  LightGridOptions how;
  how.resolution = static_cast<int>(a.resolution);
  how.seed = common.seed;
  how.lines = static_cast<size_t>(a.lines);
  how.own = in.lines;
  return how;
}

LightGrid compute(const Arguments& a, const cli::Common& common, const Loaded& in,
                  const LightGridOptions& how, const MakeLineTracer& make_tracer,
                  LightGridReport& report) {
  ProgressBar progress("tracing", "segments", how.samples, common.quiet);
  LightGrid grid =
      make_light_grid(in.scene, in.cut, a.cut, how, report,
                      {[&](uint64_t n) { progress.advance(n); }, stop_requested}, make_tracer);
  grid.provenance = common.provenance(in.files);
  grid.cameras = in.cut.cameras;
  return grid;
}

void note_counts(const cli::Common& common, const LightGrid& grid, const LightGridReport& report,
                 const Arguments& a) {
  const PassStatistics all = report.all();
  if (!grid.bottleneck) return common.note("no bottleneck: " + grid.reason);
  if (!a.lines_from.empty())
    return common.note(
        fmt::format("{} of {} join the two sides", all.joined, counted(all.tried, "line")));
  common.note(fmt::format(
      "counted {} of light from the lit side to the camera's{}", counted(all.kept, "line"),
      all.settled ? ""
                  : "; that is too few for settled counts: --quality high draws "
                    "more"));
}

nlohmann::json summary(const LightGrid& grid, const LightGridReport& report,
                       const std::string& device) {
  const PassStatistics all = report.all();
  return {{"bottleneck", grid.bottleneck}, {"reason", grid.reason},     {"drawn", all.drawn},
          {"visible", all.visible},        {"kept", all.kept},          {"settled", all.settled},
          {"change", all.change},          {"tried", all.tried},        {"joined", all.joined},
          {"lines", grid.lines.size()},    {"voxels", grid.dim},        {"air", report.air},
          {"voxel", grid.voxel},           {"fullest", report.fullest}, {"device", device}};
}

// ---- The text of --explain ----

using cli::Decision;
using cli::Decisions;

Decision of_box(const Scene& scene, const LightGrid& grid, const LightGridOptions& options,
                const LightGridReport& report) {
  const Vec3d whole = box_of(scene).size() / scene.frame.scale;
  const Vec3d side = Vec3d(grid.dim[0], grid.dim[1], grid.dim[2]) * grid.voxel;
  return {"grid",
          fmt::format("{} x {} x {} voxels of {} m", grid.dim[0], grid.dim[1], grid.dim[2],
                      number_words(grid.voxel)),
          fmt::format("the patches of the cut reach over {} x {} x {} m of {} x "
                      "{} x {} m, and --resolution is {}",
                      number_words(side.x), number_words(side.y), number_words(side.z),
                      number_words(whole.x), number_words(whole.y), number_words(whole.z),
                      options.resolution),
          fmt::format("{:.1f} MiB; air marked in {}",
                      static_cast<double>(grid.count.size()) *
                          (sizeof(float) + 1 + sizeof(Vec3f) + sizeof(Vec3d)) / (1 << 20),
                      cli::price_of(report.phases, {"air"}))};
}

Decision of_batches(const std::string& cut, const PassStatistics& c,
                    const LightGridOptions& options) {
  if (c.drawn == 0) return {cut, "nothing drawn", "no pair of it has any surface", "no segment"};
  const std::string change = fmt::format("the counts changed by {:.1f} %, {:.0f} % is settled",
                                         100 * c.change, 100 * options.tolerance);
  return {cut + ", segments", "stopped after " + counted(c.batches, "batch"),
          c.settled                    ? change
          : c.drawn >= options.samples ? fmt::format("{} are the most: ", options.samples) + change
                                       : "a signal came: " + change,
          counted(c.drawn, "segment")};
}

Decision of_leaks(const std::string& cut, const PassStatistics& c) {
  return {cut + ", leaks", fmt::format("{} of {} visible segments kept", c.kept, c.visible),
          "short rays around the ends of the others see the wrong side of the cut",
          fmt::format("{} hidden ones dropped", c.drawn - c.visible)};
}

Decision of_lines(const std::string& cut, const PassStatistics& c,
                  const LightGridOptions& options) {
  if (c.kept == 0)
    return {cut + ", lines", "none", "no segment joins the two sides", "no fine pass"};
  return {
      cut + ", lines", fmt::format("{} kept", c.lines),
      fmt::format("--set lines allows {}, and {} of {} drawn through the light join the two sides",
                  options.lines, c.joined, c.tried),
      counted(c.tried, "line") + " tried"};
}

// `device`: what traced the lines.
Decisions decisions_of(const Scene& scene, const LightGrid& grid, const LightGridOptions& options,
                       const LightGridReport& report, const std::string& device) {
  Decisions all = uses_of(scene, {"transmission", "alpha", "a sky"});
  if (report.all().drawn == 0) {
    all.push_back({"light grid", "empty", grid.reason, "nothing is traced"});
    return all;
  }
  if (grid.bottleneck) all.push_back(of_box(scene, grid, options, report));
  all.push_back({"lines", "traced by " + device, "--device says so or is not given",
                 fmt::format("coarse {}, fine {}", cli::price_of(report.phases, {"coarse"}),
                             cli::price_of(report.phases, {"fine"}))});
  for (size_t c = 0; c < report.cuts.size(); ++c) {
    const std::string cut = fmt::format("cut {}", c + 1);
    if (!options.own.empty()) {
      all.push_back({cut + ", lines", fmt::format("{} kept", report.cuts[c].lines),
                     "--lines-from gives them", counted(report.cuts[c].tried, "line") + " tried"});
      continue;
    }
    all.push_back(of_batches(cut, report.cuts[c], options));
    if (report.cuts[c].drawn == 0) continue;
    all.push_back(of_leaks(cut, report.cuts[c]));
    all.push_back(of_lines(cut, report.cuts[c], options));
  }
  if (!grid.bottleneck)
    all.push_back({"light grid", "empty", grid.reason, "portalfit has nothing to do"});
  return all;
}

int run(const Arguments& a, const cli::Common& common) {
  const NamedTracer tracer = tracer_on(a.device);
  if (!a.preview.empty()) draw::check_fonts();
  catch_signals();
  if (a.device != "cpu") common.note("lines are traced by " + tracer.words + ".");
  LightGridReport report;
  const Loaded in = load(a, common);
  report.phases.done("load");
  const LightGridOptions how = options_of(a, common, in);
  const LightGrid grid = compute(a, common, in, how, tracer.make, report);
  note_counts(common, grid, report, a);
  common.explain_by([&] { return decisions_of(in.scene, grid, how, report, tracer.name); });
  cli::deliver(
      {{common.output, [&] { return light_grid_bytes(grid, a.z_up); }},
       {a.preview, [&] { return draw::draw(grid_preview(grid, a.scene)).file_named(a.preview); }},
       {a.debug_glb, [&] { return grid_debug_glb(grid); }}},
      common, report.phases);
  cli::report(common, summary(grid, report, tracer.name), report.phases);
  if (!report.stopped) return 0;
  common.warn("stopped by a signal; the grid holds what was drawn until then");
  return static_cast<int>(Exit::interrupted);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
