#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/phases.h"
#include "libcommon/base/threads.h"
#include "libcommon/cli/cli.h"
#include "libcommon/formats/portal_worth.h"
#include "tools/portalfit/merit.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/preview.h"

int main(int argc, char** argv) {
  using namespace tdpt;
  cli::Options options("portalfit", "Fits planar light portals to a light grid.",
                       "The portals (.glb); default standard output");
  PortalFitOptions how;
  std::string grid_path = "-", preview, debug_glb;
  std::string method = "tube";
  int64_t max_portals = 8;
  bool require_portal = false, useful_only = false;
  options.argument("grid", grid_path, "The light grid (.vdb); default standard input", false);
  options.option("--threshold", how.threshold, "T",
                 "Smallest share of the lines that makes a portal; default 0.05", 0.0001, 1);
  options.option("--max-portals", max_portals, "N", "Most portals; default 8", 1, 1000);
  options.choice("--method", method, {"tube", "paper"},
                 "How a portal is fitted: tube, the default, or the rule of the paper");
  options.flag("--require-portal", require_portal, "Exit with 3 when no portal is found",
               cli::Shapes::nothing);
  options.flag("--useful-only", useful_only, "Leave out portals that cost more than they gain");
  options.side_output("--preview", preview,
                      "Write a PNG: each portal over the light, from the front and from above");
  options.side_output("--debug-glb", debug_glb,
                      "Write portals, their normals and some lines of light as glTF");
  return options.run_main(argc, argv, [&] {
    const cli::Common& common = options.common;
    how.by_paper = method == "paper";
    how.max_portals = static_cast<size_t>(max_portals);
    Phases phases;
    const LightGrid grid = read_light_grid(grid_path);
    phases.done("load");
    FitResult fit = fit_portals(grid, how);
    appraise(grid, fit.portals);
    phases.done("fit");
    PortalFile file;
    for (const Portal& portal : fit.portals)
      if (!useful_only || verdict_of(portal.figures).worth != Worth::useless)
        file.portals.push_back(portal);
    file.scene_hash = grid.scene_hash;
    file.provenance = common.provenance({{grid_path, grid.hash, grid.provenance}});
    nlohmann::json summary = {{"portals", nlohmann::json::array()},
                              {"explained", fit.explained},
                              {"refused", fit.refused}};
    size_t left_out = 0;
    for (const Portal& portal : fit.portals) {
      const auto& f = portal.figures;
      const Verdict verdict = verdict_of(f);
      std::string support;
      if (f.contains("support")) support = fmt::format("support {:.2f}, ", f.at("support"));
      const bool written = !useful_only || verdict.worth != Worth::useless;
      const size_t number = summary["portals"].size();
      common.note(fmt::format("{}: {} ({}{:.0f} degrees between normal and mean direction).",
                              written ? fmt::format("portal.{}", number) : "left out",
                              worth_sentence(f, f.at("area")), support, f.at("direction_angle")));
      left_out += !written;
      if (!written) continue;
      nlohmann::json entry = f;
      entry["name"] = fmt::format("portal.{}", number);
      entry["worth"] = verdict.words;
      summary["portals"].push_back(entry);
    }
    summary["left_out"] = left_out;
    for (const std::string& sentence : fit.refused) common.note("refused: " + sentence + ".");
    if (file.portals.empty()) {
      const std::string why = left_out > 0      ? "none found is useful"
                              : grid.bottleneck ? "no planar opening fits the light"
                                                : grid.reason;
      if (require_portal)
        throw InputError(grid_path == "-" ? "(standard input)" : grid_path, "",
                         "gives no portal: " + why);
      common.note("no portal: " + why + ".");
      summary["reason"] = why;
    }
    write_output(common.output, portal_bytes(file));
    phases.done("write");
    if (!preview.empty())
      write_output(preview, portal_preview(grid, file.portals, grid_path,
                                           grid.bottleneck ? "no planar opening fits the light"
                                                           : grid.reason));
    if (!debug_glb.empty()) write_output(debug_glb, portal_debug_glb(grid, file));
    if (!(preview.empty() && debug_glb.empty())) phases.done("pictures");
    summary["phases"] = phases;
    summary["cpu_seconds"] = cpu_seconds();
    summary["peak_bytes"] = peak_memory();
    common.summary(summary.dump());
    return 0;
  });
}
