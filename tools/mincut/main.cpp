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
  std::string network = "-", scene, camera, preview, debug_glb;
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
  options.option("--camera", a.camera, "NAME",
                 "Camera for --preview; default the first of the network", cli::Effect::report);
  options.side_output("--debug-glb", a.debug_glb,
                      "Write the same as glTF: patches as coloured squares, pairs as lines");
  declare_pose_options(options, a.pose, cli::Effect::report);
  options.limit("least-area", a.limits.least_area, 0, 1);
  options.limit("least-carried", a.limits.least_carried, 0, 1);
  options.limit("straight", a.limits.straight, 0, 1);
  options.limit("seen", a.limits.seen, 0, 1);
  options.limit("hold", a.limits.hold, 0, 1);
  options.limit("least-drop", a.limits.least_drop, 0, 1);
  options.limit("loose", a.limits.loose, 0, 1e9);
  options.limit("most-drops", a.limits.most_drops, 0, 1e9);
}

constexpr double kFarthest = 1e6;  // sizes of the scene: no program stands a camera beyond

// Which of the network's cameras is shown: the one of that name, else the first.
size_t shown_camera(const Arguments& a, const CutFile& cut) {
  for (size_t k = 0; k < cut.cameras.size(); ++k)
    if (const auto made_for = parse_viewpoint(cut.cameras[k]); made_for->name == a.camera) return k;
  return 0;
}

// The one that the network was made for, where it says so.
Camera camera_of(const Arguments& a, const Scene& scene, const CutFile& cut) {
  const auto made_for = parse_viewpoint(cut.cameras.empty() ? "" : cut.cameras[0]);
  if (!a.camera.empty() || !made_for) return scene.camera(a.camera);
  const Camera camera = tdpt::camera_of(scene.frame, *made_for);
  if (!(length(camera.position) <= kFarthest))
    throw InputError(display_name(a.network), "", "its camera stands far away from " + scene.path);
  return camera;
}

// The scene for --preview; without it none is read.
std::string preview_of(const Arguments& a, const cli::Common& common, const FoundCuts& found) {
  Scene scene = read_gltf(a.scene, a.pose);
  common.also_read(scene.files);
  open_glass(scene);
  return draw::draw(cut_preview(scene, camera_of(a, scene, found.file),
                                cuts_for(found, shown_camera(a, found.file)), a.network))
      .file_named(a.preview);
}

void check(const Arguments& a) {
  if (!a.preview.empty() && a.scene.empty())
    throw UsageError("--preview shows the scene: name it with --scene FILE");
  if (a.preview.empty() && !(a.scene.empty() && a.camera.empty()))
    throw UsageError("--scene and --camera go with --preview");
  if (a.scene.empty() && a.pose.is_given())
    throw UsageError("--at and --animation go with --scene");
  if (a.scene == "-" && a.network == "-")
    throw UsageError("network and scene cannot both be the standard input");
  if (!a.preview.empty()) draw::check_fonts();
}

Provenance provenance(const Arguments& a, const cli::Common& common, const DimacsFile& problem) {
  return common.provenance({{a.network, problem.hash, problem.provenance}});
}

// Of a network that does not come from ffgraph: one cut, as text.
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
                           "the network has no patches to tell bottlenecks by",
                           cli::price_of(phases, {"flow"})}};
  });
}

Json json_of(const CutFacts& facts) {
  Json json{{"conductance", facts.conductance},
            {"light_side", facts.area[0]},
            {"camera_side", facts.area[1]}};
  if (facts.carried) json["carried"] = *facts.carried;
  if (facts.carried_back) json["carried_back"] = *facts.carried_back;
  if (facts.straight) json["straight"] = *facts.straight;
  if (facts.seen) json["seen"] = *facts.seen;
  return json;
}

std::string bottlenecks_sentence(const std::vector<CutFacts>& cuts) {
  const auto narrowest = std::min_element(
      cuts.begin(), cuts.end(),
      [](const CutFacts& a, const CutFacts& b) { return a.conductance < b.conductance; });
  return fmt::format("{} between light and camera{} lets {} of the light through",
                     counted(cuts.size(), "bottleneck"),
                     cuts.size() > 1 ? "; the narrowest" : ", which",
                     percent_words(narrowest->conductance));
}

// Of the light's way to one camera. `cuts`: those that serve it.
std::string sentence_of(const SeriesCut& found, const std::vector<CutFacts>& cuts) {
  if (found.reason.empty() && cuts.empty()) return "the cuts of other cameras fill the file";
  return found.reason.empty() ? bottlenecks_sentence(cuts) : "no bottleneck: " + found.reason;
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
  summary["cuts"] = Json::array();
  for (size_t c = 0; c < cut.cuts.size(); ++c) {
    summary["cuts"].push_back({{"flow", cut.cuts[c].flow}, {"pairs", pairs_of(cut, c)}});
    summary["cuts"].back().update(json_of(found.facts[c]));
    if (const std::string name = cut.name_if_several(cut.cuts[c].camera); !name.empty())
      summary["cuts"].back()["camera"] = name;
  }
  summary["refused"] = Json::array();
  for (size_t k = 0; k < found.cameras.size(); ++k) {
    const std::string name = cut.name_if_several(k);
    for (const SeriesCut::Refused& r : found.cameras[k].refused) {
      summary["refused"].push_back(json_of(r.facts));
      summary["refused"].back()["why"] = r.why;
      if (!name.empty()) summary["refused"].back()["camera"] = name;
    }
    std::vector<CutFacts> own;
    for (size_t c = 0; c < cut.cuts.size(); ++c)
      if (cut.cuts[c].camera == k) own.push_back(found.facts[c]);
    common.note((name.empty() ? "" : name + ": ") + sentence_of(found.cameras[k], own));
  }
  if (!cut.bottleneck) summary["reason"] = cut.reason;
}

// ---- The text of --explain: each cut kept or refused, and where the search ended ----

using cli::Decision;
using cli::Decisions;

// The two figures by which every cut is judged.
std::string figures(const CutFacts& f, const CutLimits& limits) {
  return fmt::format("conductance {}, at most {}; smaller side {}, at least {}",
                     number_words(f.conductance, 2), number_words(limits.largest_conductance, 2),
                     percent_words(f.smaller_side()), percent_words(limits.least_area));
}

Decision of_search(const SeriesCut& found, const std::string& price) {
  return {"search", fmt::format("ended after {} of the potential", counted(found.drops, "drop")),
          found.passed > 0
              ? fmt::format("{} more {} wider", found.passed, found.passed == 1 ? "is" : "are")
              : "the potential falls nowhere else",
          price};
}

// Refused cuts that are bottlenecks all the same.
size_t one_too_many(const SeriesCut& found, const CutLimits& limits) {
  size_t n = 0;
  for (const SeriesCut::Refused& r : found.refused) n += why_refused(r.facts, limits).empty();
  return n;
}

// Of one camera: what was refused and where the search ended. `name`: empty for the only one.
void add_camera(const SeriesCut& found, const std::string& name, size_t most,
                const CutLimits& limits, const std::string& price, Decisions& all) {
  const std::string before = name.empty() ? "" : name + ": ";
  for (const SeriesCut::Refused& r : found.refused)
    all.push_back({fmt::format("{}a cut with {} of the surface on the light's side", before,
                               percent_words(r.facts.area[0])),
                   "refused", r.why + ": " + figures(r.facts, limits), ""});
  if (found.closets > 0)
    all.push_back({before + "closets", fmt::format("{} passed by", found.closets),
                   "no light passes their doors on its way to the camera", "not cut"});
  all.push_back(of_search(found, price));
  all.back().what = before + all.back().what;
  if (const size_t more = one_too_many(found, limits); more > 0)
    all.push_back({before + counted(more, "bottleneck"), "left out",
                   fmt::format("--cuts is {}, and others promise more", most), ""});
}

// `most`: number of cuts asked for. Of the phases only `flow` is used.
Decisions decisions_of(const FoundCuts& found, size_t most, const CutLimits& limits,
                       const Phases& phases) {
  Decisions all;
  for (size_t c = 0; found.file.bottleneck && c < found.facts.size(); ++c)
    all.push_back({fmt::format("cut {}", c + 1), "kept",
                   fmt::format("light has to pass it: {}; {}", figures(found.facts[c], limits),
                               words_for(found.facts[c])),
                   counted(pairs_of(found.file, c), "pivot pair")});
  const std::string flows = fmt::format("{}, verified", counted(found.flows, "maximum flow"));
  for (size_t k = 0; k < found.cameras.size(); ++k) {
    const bool last = k + 1 == found.cameras.size();
    add_camera(found.cameras[k], found.file.name_if_several(k), most, limits,
               last ? flows + ": " + cli::price_of(phases, {"flow"}) : "", all);
  }
  if (found.left_out > 0)
    all.push_back(
        {counted(found.left_out, "cut"), "left out",
         fmt::format("a file has {} at most, and others of the camera promise more", kMostCuts),
         ""});
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
  cli::deliver(
      {{common.output, [&] { return cut_text(cut); }},
       {a.preview, [&] { return preview_of(a, common, found); }},
       {a.debug_glb, [&] { return cut_debug_glb(cuts_for(found, shown_camera(a, cut))); }}},
      common, phases);
  report(common, found, summary);
  common.explain_by(
      [&] { return decisions_of(found, static_cast<size_t>(a.cuts), a.limits, phases); });
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
