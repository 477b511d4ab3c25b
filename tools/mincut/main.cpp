// mincut: finds the minimum cuts of a flow network, and verifies them.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/draw/drawing.h"
#include "libcommon/flow/cut_facts.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/options/shot_options.h"
#include "tools/mincut/cut_of.h"
#include "tools/mincut/preview.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr cli::Program kProgram{"mincut",
                                "Finds and verifies the minimum cut of a flow network.",
                                "Cut to write; default standard output",
                                cli::Result::text,
                                cli::kLibraries,
                                cli::kCommit,
                                cli::kThreads | cli::kQuiet};

struct Arguments {
  std::string network = "-", scene, preview, debug_glb;
  int64_t cuts = 8;
  Pose pose;
  CutLimits limits;
};

void declare_options(cli::Options& options, Arguments& a) {
  options.argument("network", a.network,
                   "Network (.max, a DIMACS maximum-flow problem); default standard input", false);
  options.option("--cuts,--set cuts", a.cuts, "K",
                 "Most bottlenecks to look for, one behind the other, for each camera; default 8",
                 1, 64);
  options.option("--set largest-conductance", a.limits.largest_conductance, "C",
                 "Largest share of the smaller side's light that may cross; default 0.12", 0, 1);
  options.side_output("--preview", a.preview,
                      "Write a picture (.png, .svg, .pdf): the cut's sides and pivot pairs in the "
                      "scene and in plan");
  options.input("--scene", a.scene, "FILE", "Scene of the network (.glb, .gltf), for --preview");
  options.side_output("--debug-glb", a.debug_glb,
                      "Write the same as glTF: patches as coloured squares, pairs as lines");
  declare_pose_options(options, a.pose, cli::Effect::report);
  options.limit("least-area", a.limits.least_area, 0, 1);
  options.limit("least-carried", a.limits.least_carried, 0, 1);
  options.limit("straight", a.limits.straight, 0, 1);
  options.limit("seen", a.limits.seen, 0, 1);
  options.limit("least-drop", a.limits.least_drop, 0, 1);
}

constexpr double kFarthest = 1e6;  // sizes of the scene: no program stands a camera beyond

// The scene for --preview, as the first camera of the network sees it; without it none is read.
std::string preview_of(const Arguments& a, const cli::Common& common, const FoundCuts& found) {
  Scene scene = read_gltf(a.scene, a.pose);
  common.also_read(scene.files);
  open_glass(scene);
  const auto made_for =
      parse_viewpoint(found.file.cameras.empty() ? "" : found.file.cameras.front());
  const Camera camera = made_for ? camera_of(scene.frame, *made_for) : scene.camera("");
  if (!(length(camera.position) <= kFarthest))
    throw InputError(display_name(a.network), "", "its camera stands far away from " + scene.path);
  return draw::draw(cut_preview(scene, camera, cuts_for(found, 0), a.network))
      .file_named(a.preview);
}

void check(const Arguments& a) {
  if (!a.preview.empty() && a.scene.empty())
    throw UsageError("--preview shows the scene: name it with --scene FILE");
  if (a.preview.empty() && !a.scene.empty()) throw UsageError("--scene goes with --preview");
  if (a.scene.empty() && a.pose.is_given())
    throw UsageError("--at and --animation go with --scene");
  if (a.scene == "-" && a.network == "-")
    throw UsageError("network and scene cannot both be the standard input");
  if (!a.preview.empty()) draw::check_fonts();
}

Provenance provenance(const Arguments& a, const cli::Common& common, const DimacsFile& problem) {
  return common.provenance({{a.network, problem.hash, problem.provenance}});
}

// Writes one cut as text, for a network that does not come from ffgraph.
void cut_plain(const Arguments& a, const cli::Common& common, const DimacsFile& problem,
               Phases& phases, Json& summary) {
  if (!a.preview.empty() || !a.debug_glb.empty())
    throw InputError(display_name(a.network), "",
                     "is a plain network, expected one of ffgraph's to draw");
  const MaxFlow flow = max_flow(problem.network);
  verify_max_flow(problem.network, flow);
  phases.done("flow");
  summary["flow"] = flow.value;
  const auto text = [&] { return plain_cut_text(problem, flow, provenance(a, common, problem)); };
  cli::deliver({{common.output, text}}, common, phases);
  common.note(fmt::format("maximum flow {}", flow.value));
  common.explain_by([&] {
    return cli::Decisions{{"search", "ended after the minimum cut",
                           "a network without patches has no bottlenecks",
                           cli::price_of(phases, {"flow"})}};
  });
}

// `camera`: its name; empty for the only one.
Json json_of(const CutFacts& facts, const std::string& camera) {
  Json json{{"conductance", facts.conductance},
            {"light_side", facts.side[0].area},
            {"camera_side", facts.side[1].area}};
  if (facts.carried) json["carried"] = *facts.carried;
  if (facts.carried_back) json["carried_back"] = *facts.carried_back;
  if (facts.straight) json["straight"] = *facts.straight;
  if (facts.seen) json["seen"] = *facts.seen;
  if (!camera.empty()) json["camera"] = camera;
  return json;
}

// Describes the light's way to one camera. `cuts`: those that serve it.
std::string sentence_of(const SeriesCut& found, const std::vector<CutFacts>& cuts) {
  if (!found.reason.empty()) return "no bottleneck: " + found.reason;
  if (cuts.empty()) return "the cuts of other cameras fill the file";
  double narrowest = 1;
  for (const CutFacts& cut : cuts) narrowest = std::min(narrowest, cut.conductance);
  return fmt::format("{} between light and camera{} lets {} of the light through",
                     counted(cuts.size(), "bottleneck"),
                     cuts.size() > 1 ? "; the narrowest" : ", which", percent_words(narrowest));
}

size_t pairs_of(const CutFile& cut, size_t c) {
  return static_cast<size_t>(std::count_if(cut.arcs.begin(), cut.arcs.end(),
                                           [&](const CutArc& a) { return cut.crosses(a, c); }));
}

// A note for each camera, and what the summary says of the bottlenecks and of the cuts that are
// none.
void report(const cli::Common& common, const FoundCuts& found, Json& summary) {
  const CutFile& cut = found.file;
  summary["bottleneck"] = cut.bottleneck;
  summary["cuts"] = summary["refused"] = Json::array();
  for (size_t c = 0; c < cut.cuts.size(); ++c) {
    Json& json = summary["cuts"].emplace_back(
        json_of(found.facts[c], cut.name_if_several(cut.cuts[c].camera)));
    json["flow"] = cut.cuts[c].flow;
    json["pairs"] = pairs_of(cut, c);
  }
  for (size_t k = 0; k < found.cameras.size(); ++k) {
    const std::string name = cut.name_if_several(k);
    for (const SeriesCut::Refused& r : found.cameras[k].refused)
      summary["refused"].emplace_back(json_of(r.facts, name))["why"] = r.why;
    std::vector<CutFacts> own;
    for (size_t c = 0; c < cut.cuts.size(); ++c)
      if (cut.cuts[c].camera == k) own.push_back(found.facts[c]);
    common.note((name.empty() ? "" : name + ": ") + sentence_of(found.cameras[k], own));
  }
  if (!cut.bottleneck) summary["reason"] = cut.reason;
}

// Each cut kept or refused, and where the search ended.
cli::Decisions decisions_of(const FoundCuts& found, const CutLimits& limits, const Phases& phases) {
  const auto figures = [&](const CutFacts& f) {
    return fmt::format("conductance {}, at most {}; smaller side {}, at least {}{}",
                       number_words(f.conductance, 2), number_words(limits.largest_conductance, 2),
                       percent_words(f.smaller_side()), percent_words(limits.least_area),
                       f.carried ? fmt::format("; by the network {} of the light crosses",
                                               percent_words(*f.carried))
                                 : "");
  };
  cli::Decisions all;
  for (size_t c = 0; found.file.bottleneck && c < found.facts.size(); ++c)
    all.push_back({fmt::format("cut {}", c + 1), "kept",
                   "light has to pass it: " + figures(found.facts[c]),
                   counted(pairs_of(found.file, c), "pivot pair")});
  for (size_t k = 0; k < found.cameras.size(); ++k) {
    const SeriesCut& series = found.cameras[k];
    const std::string name = found.file.name_if_several(k),
                      before = name.empty() ? "" : name + ": ";
    for (const SeriesCut::Refused& r : series.refused)
      all.push_back({fmt::format("{}a cut with {} of the surface on the light's side", before,
                                 percent_words(r.facts.side[0].area)),
                     "refused", r.why + ": " + figures(r.facts), ""});
    all.push_back({before + "search",
                   fmt::format("ended after {} of the potential", counted(series.drops, "drop")),
                   series.passed > 0 ? counted(series.passed, "wider drop") + " would come next"
                                     : "the potential falls nowhere else",
                   cli::price_of(phases, {"flow"}) + " in all"});
  }
  if (!found.file.bottleneck)
    all.push_back({"bottleneck", "none", found.file.reason, "the next stages have nothing to do"});
  return all;
}

void cut_patches(const Arguments& a, const cli::Common& common, const DimacsFile& problem,
                 Phases& phases, Json& summary) {
  FoundCuts found = cut_of(problem, static_cast<size_t>(a.cuts), a.limits);
  CutFile& cut = found.file;
  cut.provenance = provenance(a, common, problem);
  phases.done("flow");
  cli::deliver({{common.output, [&] { return cut_text(cut); }},
                {a.preview, [&] { return preview_of(a, common, found); }},
                {a.debug_glb, [&] { return cut_debug_glb(cuts_for(found, 0)); }}},
               common, phases);
  report(common, found, summary);
  common.explain_by([&] { return decisions_of(found, a.limits, phases); });
}

int run(const Arguments& a, const cli::Common& common) {
  check(a);
  Phases phases;
  const DimacsFile problem = read_dimacs(a.network);
  phases.done("load");
  Json summary;
  summary["nodes"] = problem.network.nodes;
  summary["arcs"] = problem.network.arcs.size();
  summary["scale"] = problem.scale;
  (problem.has_patches ? cut_patches : cut_plain)(a, common, problem, phases, summary);
  cli::report(common, summary, phases);
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
