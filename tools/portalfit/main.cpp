// portalfit: fits planar light portals to a light grid.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/draw/drawing.h"
#include "libcommon/formats/light_tables.h"
#include "libcommon/formats/portal.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/options/shot_options.h"
#include "tools/portalfit/plane.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/preview.h"
#include "tools/portalfit/renderers.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{"portalfit",
                                "Fits planar light portals to a light grid.",
                                "The portals (.glb, or the text of --for); default standard output",
                                cli::Result::binary,
                                cli::kLibraries,
                                cli::kCommit,
                                cli::kThreads | cli::kQuiet};

struct Arguments {
  std::vector<std::string> grid{"-"};
  std::string renderer, preview, scene, debug_glb;
  PortalFitOptions fit;
  bool require_portal = false;
  Pose pose;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.arguments("grid", a.grid,
                    "The light grid (.vdb), or tables of it (.csv) with that of its lines among "
                    "them; default standard input");
  options.option("--threshold,--set threshold", a.fit.threshold, "T",
                 "Smallest share of a camera's light that makes a portal; default 0.02", 0.0001, 1);
  options.option("--max-portals,--set max-portals", a.fit.max_portals, "N",
                 "Most portals for each camera; default 8", 1, 1000);
  options.choice("--set method", a.fit.method, {"tube", "paper"},
                 "How a portal is fitted: tube, the default, or the rule of the paper");
  options.choice(
      "--for", a.renderer, renderer_names(),
      "Write the portals as rectangles in the terms of another renderer, in place of glTF");
  options.result_is_text([&a] { return !a.renderer.empty(); });
  options.flag("--require-portal", a.require_portal, "Exit with 3 when no portal is found",
               cli::Effect::report);
  options.side_output("--preview", a.preview,
                      "Write a picture (.png, .svg, .pdf): each portal over the light, from the "
                      "front and from above; with --scene the plans instead");
  options.input("--scene", a.scene, "FILE",
                "Scene of the grid (.glb, .gltf): --preview draws its plan, storey by storey, with "
                "the portals");
  options.side_output("--debug-glb", a.debug_glb,
                      "Write portals, their normals and some lines of light as glTF");
  declare_pose_options(options, a.pose, cli::Effect::report);
  options.limit("least-edge", a.fit.least_edge, 0, 1);
}

// The plans of the scene, for the first camera that the grid was made for, where it says so.
std::string plan_of(const Arguments& a, const cli::Common& common, const LightGrid& grid,
                    const FitResult& found, const std::string& why_none) {
  Scene scene = read_gltf(a.scene, a.pose);
  common.also_read(scene.files);
  if (!scene.is_scene_of(grid.scene_hash))
    throw InputError(display_name(a.grid.front()), "",
                     "was made from another scene than " + a.scene);
  const auto made_for = parse_viewpoint(grid.cameras.empty() ? "" : grid.cameras[0]);
  const Camera camera = made_for ? camera_of(scene.frame, *made_for) : scene.camera("");
  return draw::draw(plan_preview(scene, camera, found, why_none)).file_named(a.preview);
}

// "3 portals: portal.0 0.69 m2, ..."; of many only the first are named.
std::string portals_sentence(const std::vector<Portal>& portals) {
  constexpr size_t kMostNamed = 4;
  const size_t n = portals.size(), shown = n <= kMostNamed ? n : kMostNamed - 1;
  std::vector<std::string> named;
  for (size_t i = 0; i < shown; ++i) {
    const auto& f = portals[i].figures;
    const std::string drawback = drawback_of(f);
    named.push_back(fmt::format("portal.{} {} m2{}", i, number_words(f.at("area"), 2),
                                drawback.empty() ? "" : " (" + drawback + ")"));
  }
  if (shown < n) named.push_back(fmt::format("and {} more", n - shown));
  return fmt::format("{}: {}", counted(n, "portal"), fmt::join(named, ", "));
}

// Notes, and what the summary says of the portals.
nlohmann::json portals_json(const cli::Common& common, const FitResult& found) {
  nlohmann::json written = nlohmann::json::array(), refused = nlohmann::json::array();
  for (const Portal& portal : found.portals) {
    nlohmann::json entry = portal.figures;
    entry["name"] = fmt::format("portal.{}", written.size());
    entry["drawback"] = drawback_of(portal.figures);
    if (!portal.cameras.empty()) entry["cameras"] = portal.cameras;
    written.push_back(entry);
  }
  if (!found.portals.empty()) common.note(portals_sentence(found.portals));
  if (!written.empty() && !found.refused.empty() && found.explained < kPlaneHolds)
    common.note("no further opening: the rest of the light does not pass one narrow place");
  for (const FitResult::Refusal& r : found.refused) refused.push_back(r.why);
  return {{"portals", written}, {"explained", found.explained}, {"refused", refused}};
}

// Each portal that is written or refused, with its figure and the limit.
cli::Decisions decisions_of(const LightGrid& grid, const PortalFitOptions& options,
                            const FitResult& found, const Phases& phases) {
  cli::Decisions all;
  all.push_back({"search",
                 fmt::format("{} fitted, {} refused", found.portals.size(), found.refused.size()),
                 grid.bottleneck ? fmt::format("{} of {} lines cross what was found",
                                               percent_words(found.explained, 3), grid.lines.size())
                                 : grid.reason,
                 cli::price_of(phases, {"fit"})});
  for (size_t n = 0; n < found.portals.size(); ++n) {
    const auto& f = found.portals[n].figures;
    std::string why =
        fmt::format("by the network {} of the light crosses it, at least {}; ",
                    percent_words(f.at("flux_share"), 3), percent_words(options.threshold, 3));
    if (const auto support = f.find("support"); support != f.end())
      why += fmt::format("{} of the lines through it join the two sides, at least {}; ",
                         percent_words(support->second, 3), percent_words(kMost, 3));
    why += fmt::format("{}; {:.0f} degrees between its normal and the mean direction of the light",
                       worth_sentence(f, f.at("area")), f.at("direction_angle"));
    all.push_back(
        {fmt::format("portal.{}", n), "written", why, number_words(f.at("area")) + " m2"});
  }
  for (const FitResult::Refusal& r : found.refused)
    all.push_back({"candidate", "refused", r.why, ""});
  return all;
}

// Which of the portals another renderer is given: those of the sky.
void note_inner_portals(const cli::Common& common, const LightGrid& grid,
                        const std::vector<Portal>& portals) {
  const auto outer =
      static_cast<size_t>(std::count_if(portals.begin(), portals.end(), lets_in_sky));
  if (outer == portals.size()) return;
  if (outer > 0)
    return common.note(fmt::format("{} of {} portals {} in the sky; the others are left out", outer,
                                   portals.size(), outer == 1 ? "lets" : "let"));
  common.warn(fmt::format(
      "no portal lets in the sky, which other renderers have portals for; all are left out{}",
      is_under_sky(grid.scene_hash) ? ""
                                    : ". The scene has no sky: give ffgraph and lightgrid an "
                                      "--environment"));
}

int run(const Arguments& a, const cli::Common& common) {
  if (a.preview.empty() && !a.scene.empty()) throw UsageError("--scene goes with --preview");
  if (a.scene.empty() && a.pose.is_given())
    throw UsageError("--at and --animation go with --scene");
  if (!a.preview.empty()) draw::check_fonts();
  Phases phases;
  std::vector<cli::Common::Input> files;
  const LightGrid grid = read_light(a.grid, files);
  phases.done("load");
  FitResult found = fit_portals(grid, a.fit);
  appraise(grid, found.portals);
  phases.done("fit");
  PortalFile file;
  file.portals = found.portals;
  file.scene_hash = grid.scene_hash;
  file.made_for = grid.cameras;
  file.provenance = common.provenance(files);
  nlohmann::json summary = portals_json(common, found);
  const std::string why_none = grid.bottleneck ? "no planar opening fits the light" : grid.reason;
  if (found.portals.empty()) {
    if (a.require_portal)
      throw InputError(display_name(a.grid.front()), "", "gives no portal: " + why_none);
    common.note((grid.bottleneck ? "no portal: " : "no bottleneck: ") + why_none);
    summary["reason"] = why_none;
  }
  if (!a.renderer.empty()) note_inner_portals(common, grid, file.portals);
  common.explain_by([&] { return decisions_of(grid, a.fit, found, phases); });
  const auto portals = [&] {
    return a.renderer.empty() ? portal_bytes(file) : portals_for(a.renderer, file);
  };
  const auto preview = [&] {
    if (!a.scene.empty()) return plan_of(a, common, grid, found, why_none);
    return draw::draw(portal_preview(grid, found.portals, found.lines, a.grid.front(), why_none))
        .file_named(a.preview);
  };
  const auto debug_glb = [&] { return portal_debug_glb(grid, file); };
  cli::deliver({{common.output, portals}, {a.preview, preview}, {a.debug_glb, debug_glb}}, common,
               phases);
  cli::report(common, summary, phases);
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
