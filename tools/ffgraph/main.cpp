// ffgraph: light transport of a scene as a flow network.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"
#include "tools/ffgraph/rounds.h"

namespace tdpt {
namespace {

struct Arguments {
  std::string scene, camera, nodes = "patches", capacity = "etendue", refine;
  int64_t samples = 300000, walks = 100000, bounces = 12, rounds = 1;
};

int run(const Arguments& a, const cli::Common& common) {
  check_output(common.output);
  const Scene scene = read_gltf(a.scene);
  for (const std::string& warning : scene.warnings) common.warn(warning);
  const Camera& camera = scene.camera(a.camera);
  std::vector<cli::Common::Input> inputs{{a.scene, scene.hash, {}}};
  CutFile refine;
  if (!a.refine.empty()) {
    refine = read_cut(a.refine);
    if (refine.scene_hash != scene.hash)
      throw InputError(display_name(a.refine), "", "was made from another scene than " + a.scene);
    inputs.push_back({a.refine, refine.hash, refine.provenance});
  }
  GraphSettings settings;
  settings.walks = {common.seed, static_cast<uint32_t>(a.walks), static_cast<uint32_t>(a.bounces)};
  settings.rays = static_cast<uint32_t>(a.samples);
  settings.rounds = static_cast<int>(a.rounds);
  GraphReport report;
  const LightFlow flow =
      build_graph(scene, camera, settings, a.refine.empty() ? nullptr : &refine, report);
  DimacsFile file = dimacs_file(flow);
  file.provenance = common.provenance(inputs);
  write_output(common.output, dimacs_text(file));
  common.note(fmt::format(
      "{} patches, {} arcs; {} hits from the light, {} from the camera; {} split; {:.1f} CPU s",
      file.patches.size(), file.network.arcs.size(), report.light_hits, report.camera_hits,
      report.split, cpu_seconds()));
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Arguments a;
  cli::Options options("ffgraph", "Writes the light transport of a glTF scene as a flow network.",
                       "Network to write (DIMACS); default standard output");
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  options.option("--camera", a.camera, "NAME", "Camera to use; default the first");
  options.choice("--nodes", a.nodes, {"patches", "triangles"}, "What the nodes are");
  options.choice("--capacity", a.capacity, {"etendue", "formfactor"}, "What the capacities are");
  options.option("--samples", a.samples, "N", "Rays for the etendue", 1, 100000000);
  options.option("--walks", a.walks, "N", "Walks", 1, 10000000);
  options.option("--bounces", a.bounces, "N", "Bounces", 1, 64);
  options.option("--rounds", a.rounds, "N", "Rounds", 0, 8);
  options.option("--refine", a.refine, "CUT", "Cut", cli::Shapes::nothing);
  return options.run_main(argc, argv, [&] { return run(a, options.common); });
}
