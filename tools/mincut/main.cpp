// mincut: minimum cut of a flow network, verified.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/phases.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"
#include "tools/mincut/cut_of.h"
#include "tools/mincut/preview.h"
#include "tools/mincut/verify.h"

namespace tdpt {
namespace {

struct Arguments {
  std::string network = "-", scene, camera, preview, debug_glb;
  int64_t cuts = 8;
  CutLimits limits;
};

// The scene for --preview; without it none is read.
std::string preview_of(const Arguments& a, const CutFile& cut) {
  Scene scene = read_gltf(a.scene);
  open_glass(scene);
  return cut_preview(scene, scene.camera(a.camera), cut, a.network);
}

int run(const Arguments& a, const cli::Common& common) {
  if (!a.preview.empty() && a.scene.empty())
    throw UsageError("--preview shows the scene: name it with --scene FILE");
  if (a.preview.empty() && !(a.scene.empty() && a.camera.empty()))
    throw UsageError("--scene and --camera go with --preview");
  if (a.scene == "-" && a.network == "-")
    throw UsageError("network and scene cannot both be the standard input");
  Phases phases;
  const DimacsFile problem = read_dimacs(a.network);
  const Provenance provenance = common.provenance({{a.network, problem.hash, problem.provenance}});

  phases.done("load");

  nlohmann::ordered_json summary;
  summary["nodes"] = problem.network.nodes;
  summary["arcs"] = problem.network.arcs.size();
  summary["scale"] = problem.scale;
  if (!problem.has_patches) {
    if (!a.preview.empty() || !a.debug_glb.empty())
      throw InputError(display_name(a.network), "",
                       "is a plain network, expected one of ffgraph's to draw");
    const MaxFlow flow = max_flow(problem.network);
    verify_max_flow(problem.network, flow);
    phases.done("flow");
    summary["flow"] = flow.value;
    write_output(common.output, plain_cut_text(problem, flow, provenance));
    common.note(fmt::format("maximum flow {}", flow.value));
  } else {
    CutFile cut = cut_of(problem, static_cast<size_t>(a.cuts), a.limits);
    cut.provenance = provenance;
    phases.done("flow");
    const std::string preview = a.preview.empty() ? "" : preview_of(a, cut);
    const std::string debug_glb = a.debug_glb.empty() ? "" : cut_debug_glb(cut);
    if (!(preview.empty() && debug_glb.empty())) phases.done("pictures");
    write_output(common.output, cut_text(cut));
    if (!preview.empty()) write_output(a.preview, preview);
    if (!debug_glb.empty()) write_output(a.debug_glb, debug_glb);
    summary["bottleneck"] = cut.bottleneck;
    summary["cuts"] = nlohmann::ordered_json::array();
    for (size_t c = 0; c < cut.cuts.size(); ++c) {
      const auto pairs = std::count_if(cut.arcs.begin(), cut.arcs.end(),
                                       [&](const CutArc& arc) { return cut.crosses(arc, c); });
      summary["cuts"].push_back(
          {{"flow", cut.cuts[c].flow}, {"conductance", cut.cuts[c].conductance}, {"pairs", pairs}});
      if (cut.bottleneck)
        common.note(fmt::format(
            "{}{} pivot pairs; {:.2g} of the smaller side's light crosses the cut",
            cut.cuts.size() > 1 ? fmt::format("bottleneck {} of {}: ", c + 1, cut.cuts.size()) : "",
            pairs, cut.cuts[c].conductance));
    }
    if (!cut.bottleneck) {
      summary["reason"] = cut.reason;
      common.note("no bottleneck: " + cut.reason);
    }
  }
  phases.done("write");
  summary["phases"] = phases;
  summary["cpu_seconds"] = cpu_seconds();
  summary["peak_bytes"] = peak_memory();
  common.summary(summary.dump());
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Arguments a;
  cli::Options options("mincut", "Finds and verifies the minimum cut of a flow network.",
                       "Cut to write; default standard output");
  options.argument("network", a.network,
                   "Network (DIMACS maximum-flow problem); default standard input", false);
  options.option("--cuts", a.cuts, "K",
                 "Most bottlenecks to look for, one behind the other; default 8", 1, 64);
  options.option("--least-area", a.limits.least_area, "SHARE",
                 "Share of the area that the smaller side must have; default 0.03", 0, 0.5);
  options.option("--largest-conductance", a.limits.largest_conductance, "C",
                 "Largest share of the smaller side's light that may cross; default 0.12", 0, 1);
  options.side_output("--preview", a.preview,
                      "Write a PNG: the cut's sides and pivot pairs in the scene and in plan");
  options.input("--scene", a.scene, "FILE", "Scene of the network (.glb, .gltf), for --preview");
  options.option("--camera", a.camera, "NAME", "Camera for --preview; default the first one",
                 cli::Shapes::nothing);
  options.side_output("--debug-glb", a.debug_glb,
                      "Write the same as glTF: patches as coloured squares, pairs as lines");
  return options.run_main(argc, argv, [&] { return run(a, options.common); });
}
