// ffgraph: writes the light transport of a scene as a flow network.
#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/draw/drawing.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/options/camera_options.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/options/sky_options.h"
#include "libcommon/scene/lights.h"
#include "libcommon/scene/uses.h"
#include "tools/ffgraph/camera_poses.h"
#include "tools/ffgraph/preview.h"
#include "tools/ffgraph/rounds.h"
#include "tools/ffgraph/triangle_flow.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{"ffgraph",
                                "Writes the light transport of a glTF scene as a flow network.",
                                "Network to write (DIMACS); default standard output",
                                cli::Result::text,
                                cli::kLibraries,
                                cli::kCommit,
                                cli::kSeed | cli::kThreads | cli::kQuiet};

// What they are worth, doc/efficiency.md.
constexpr cli::ByQuality<int64_t> kSamples{75000, 300000, 1200000}, kWalks{25000, 100000, 400000};

struct Arguments {
  std::string scene, nodes = "patches", capacity, refine, preview, debug_glb;
  SkyArguments sky;
  CameraArguments camera;
  Pose pose;
  ShotArguments shot;
  int64_t samples = 0, walks = 0, bounces = 12, rounds = 1, cells = 24;

  bool triangles() const { return nodes == "triangles"; }
};

void declare_options(cli::Options& options, Arguments& a) {
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  options.input(
      "--refine", a.refine, "CUT",
      "Split where the patches of this cut (.cut) straddle its opening, instead of --set rounds");
  options.side_output("--preview", a.preview,
                      "Write a picture (.png, .svg, .pdf): what light and camera reach, as the "
                      "first camera sees it and in plan");
  options.side_output("--debug-glb", a.debug_glb,
                      "Write the same as glTF, the patches as coloured squares");
  options.part(cli::Part::effort);
  options.choice("--nodes,--set nodes", a.nodes, {"patches", "triangles"},
                 "What the nodes are; default patches");
  options.choice("--capacity,--set capacity", a.capacity, {"etendue", "formfactor"},
                 "What the capacities are; default etendue for patches, formfactor for triangles");
  options.quality();
  options.option("--samples,--set samples", a.samples, kSamples, "N",
                 "Rays for the etendue in each round", 1000, 100000000);
  options.option("--set walks", a.walks, kWalks, "N",
                 "Walks from the light, and as many from the camera; several cameras share them", 1,
                 10000000);
  options.option("--set bounces", a.bounces, "N", "Surfaces that a walk hits at most; default 12",
                 1, 64);
  options.option("--set cells", a.cells, "N",
                 "Patches along the diagonal of what the walks reach; default 24", 4, 256);
  options.option("--set rounds", a.rounds, "N",
                 "Rounds of splitting patches that straddle an opening; default 1", 0, 3);
  declare_camera_options(options, a.camera);
  declare_pose_options(options, a.pose);
  declare_shot_options(options, a.shot);
  declare_sky_options(options, a.sky);
}

// Hits of walks are kept in memory, 16 bytes each.
constexpr int64_t kMostHits = 100000000;
using Json = nlohmann::ordered_json;

struct Inputs {
  Scene scene;
  std::vector<Camera> cameras;
  std::optional<CutFile> refine;
  std::vector<cli::Common::Input> files;
};

void check(const Arguments& a) {
  const std::string capacity = a.triangles() ? "formfactor" : "etendue";
  if (!a.capacity.empty() && a.capacity != capacity)
    throw UsageError("--nodes " + a.nodes + " goes with --capacity " + capacity);
  if (a.triangles() && !a.refine.empty()) throw UsageError("--refine goes with --nodes patches");
  if (a.walks * a.bounces > kMostHits)
    throw UsageError(fmt::format("{} walks of {} surfaces are too many, at most {} in all", a.walks,
                                 a.bounces, kMostHits));
  check_shot(a.shot, a.pose);
  if (!a.preview.empty()) draw::check_fonts();
}

Inputs load(const Arguments& a, const cli::Common& common) {
  Inputs in;
  SceneFile file(a.scene, a.pose.animations);
  in.scene = file.at(a.shot.is_given() ? frame_range(a.shot).first / a.shot.fps : a.pose.seconds);
  common.also_read(in.scene.files);
  open_glass(in.scene);
  for (const std::string& warning : in.scene.warnings) common.warn(warning);
  if (in.scene.triangles.empty())
    throw InputError(display_name(a.scene), "", "no triangles, expected surfaces");
  in.files.push_back({a.scene, in.scene.hash, {}});
  add_sky(in.scene, a.sky, common, in.files);
  note_unit(in.scene, common);
  note_lost_light(in.scene, common);
  if (Lights(in.scene).empty())
    throw InputError(
        display_name(a.scene), "",
        "nothing emits light, expected an emissive surface, a lamp or an --environment");
  in.cameras = chosen_cameras(in.scene, a.camera, common);
  if (a.shot.is_given()) {
    const bool stands = !a.camera.look_from.empty() || a.camera.frame;
    auto poses = camera_poses(file, in.scene, stands ? std::vector<Camera>() : in.cameras, a.shot);
    if (!stands) in.cameras = std::move(poses);
  }
  if (a.triangles() && in.cameras.size() > 1)
    throw UsageError(
        fmt::format("--nodes triangles is for one camera, {} are given", in.cameras.size()));
  if (a.refine.empty()) return in;
  const CutFile& cut = in.refine.emplace(read_cut(a.refine));
  check_made_from(in.scene, cut.scene_hash, a.refine);
  check_patches(display_name(a.refine), in.scene, cut);
  in.files.push_back({a.refine, cut.hash, cut.provenance});
  return in;
}

void warn_of_no_flow(const cli::Common& common, const Inputs& in, const GraphReport& report) {
  if (report.light_hits == 0)
    common.warn("no light reaches a surface: the network carries no flow");
  for (size_t k = 0; k < in.cameras.size(); ++k)
    if (report.camera_hits[k] == 0)
      common.warn(fmt::format("the camera{} sees no surface: the network carries no flow{}",
                              in.cameras.size() > 1 ? " \"" + in.cameras[k].name + '"' : "",
                              in.cameras.size() > 1 ? " to it" : ""));
}

// All surfaces are treated as diffuse: only transmission and lamps matter.
cli::Decisions decisions_on(const Scene& scene) {
  return uses_of(scene, {"transmission", "alpha", "punctual lights", "a sky"});
}

DimacsFile graph_of_patches(const Arguments& a, const cli::Common& common, const Inputs& in,
                            Phases& phases, Json& summary) {
  GraphSettings settings;
  settings.walks = {common.seed, static_cast<uint32_t>(a.walks), static_cast<uint32_t>(a.bounces)};
  settings.rays = static_cast<uint32_t>(a.samples);
  settings.rounds = static_cast<int>(a.rounds);
  settings.cells = static_cast<double>(a.cells);
  GraphReport report;
  LightFlow flow = build_graph(in.scene, in.cameras, settings, in.refine ? &*in.refine : nullptr,
                               report, phases);
  const bool several = in.cameras.size() > 1;
  common.note(fmt::format("light and {} both reach {} of {} patches of surface",
                          several ? "cameras" : "camera", report.reached_by_both,
                          flow.patches.size()));
  warn_of_no_flow(common, in, report);
  const auto rounds = std::count_if(report.rounds.begin(), report.rounds.end(),
                                    [](const RoundReport& round) { return round.split > 0; });
  common.explain_by([&] {
    cli::Decisions all = decisions_on(in.scene);
    all.push_back({"walks", fmt::format("{} from the light", a.walks),
                   fmt::format("they hit {} and {} surfaces, and both reached {} of {} patches",
                               report.light_hits, report.hits_of_cameras(), report.reached_by_both,
                               flow.patches.size()),
                   cli::price_of(phases, {"walks"})});
    for (const RoundReport& round : report.rounds)
      all.push_back({"round", fmt::format("{} split", round.split),
                     fmt::format("so many patches straddle {}", counted(round.openings, "opening")),
                     cli::price_of(round.cpu_seconds)});
    all.push_back(
        {"splitting",
         fmt::format("stopped after {}", counted(static_cast<size_t>(rounds), "round")),
         report.why_stopped,
         fmt::format("{} rays, {} in all", report.rays, cli::price_of(phases, {"patches"}))});
    return all;
  });
  summary["light_hits"] = report.light_hits;
  summary["camera_hits"] = report.hits_of_cameras();
  summary["reached_by_both"] = report.reached_by_both;
  summary["rays"] = report.rays;
  summary["rounds"] = rounds;
  summary["split"] = report.split();
  summary["stopped"] = report.why_stopped;
  return std::move(flow.file);
}

DimacsFile graph_of_triangles(const Arguments& a, const cli::Common& common, const Inputs& in,
                              Phases& phases, Json& summary) {
  TriangleSettings settings;
  settings.seed = common.seed;
  settings.rays = static_cast<uint32_t>(a.walks);
  TriangleReport report;
  DimacsFile file = triangle_flow(in.scene, in.cameras[0], settings, report, phases);
  common.note(fmt::format("{} triangles are lit directly, the camera sees {}, {} are both",
                          report.lit, report.seen, report.shared));
  common.explain_by([&] {
    cli::Decisions all = decisions_on(in.scene);
    all.push_back({"light and camera",
                   report.shared > 0 ? "joined directly" : "not joined directly",
                   fmt::format("of the {} triangles most lit and most seen {} are both",
                               settings.largest_set, report.shared),
                   cli::price_of(phases, {"walks", "patches"})});
    return all;
  });
  summary["lit"] = report.lit;
  summary["seen"] = report.seen;
  summary["shared"] = report.shared;
  return file;
}

int run(const Arguments& a, const cli::Common& common) {
  check(a);
  Phases phases;
  const Inputs in = load(a, common);
  phases.done("load");
  Json summary;
  DimacsFile network = a.triangles() ? graph_of_triangles(a, common, in, phases, summary)
                                     : graph_of_patches(a, common, in, phases, summary);
  network.provenance = common.provenance(in.files);
  for (const Camera& camera : in.cameras)
    network.cameras.push_back(viewpoint_text(in.scene.frame, camera));
  const auto text = [&] { return dimacs_text(network); };
  const auto preview = [&] {
    return draw::draw(network_preview(in.scene, in.cameras[0], network, a.triangles()))
        .file_named(a.preview);
  };
  const auto debug_glb = [&] { return network_debug_glb(in.scene, network, a.triangles()); };
  cli::deliver({{common.output, text}, {a.preview, preview}, {a.debug_glb, debug_glb}}, common,
               phases);
  summary["patches"] = network.patches.size();
  summary["arcs"] = network.network.arcs.size();
  cli::report(common, summary, phases);
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
