// tdpt-render: renders a scene, with portals if there are any.
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/cli.h"
#include "libcommon/cli/ending.h"
#include "tools/tdpt-render/arguments.h"
#include "tools/tdpt-render/choice.h"
#include "tools/tdpt-render/covered_lamps.h"
#include "tools/tdpt-render/explain.h"
#include "tools/tdpt-render/given_portals.h"
#include "tools/tdpt-render/picture_size.h"
#include "tools/tdpt-render/portal_report.h"
#include "tools/tdpt-render/render.h"
#include "tools/tdpt-render/report.h"
#include "tools/tdpt-render/target_report.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "tdpt-render",
    "Renders a glTF scene by (tri-directional) path tracing, with portals where "
    "there are any.",
    "Picture to write (OpenEXR); default standard output"};

// Of each pixel, where nothing else says how many.
constexpr cli::ByQuality<uint64_t> kSamples{4, 16, 64};

struct Loaded {
  Scene scene;
  Camera camera;
  PictureSize size;
  std::vector<Portal> portals;
  std::vector<cli::Common::Input> files;
};

Loaded load(const Arguments& a, const cli::Common& common) {
  Loaded in;
  in.scene = read_gltf(a.scene);
  common.also_read(in.scene.files);
  for (const std::string& warning : in.scene.warnings) common.warn(warning);
  in.camera = in.scene.camera(a.camera);
  in.files.push_back({a.scene, in.scene.hash, {}});
  add_sky(in.scene, a.sky, common, in.files);
  for (const std::string& path : a.portals) {
    const GivenPortals given = read_given_portals(path, in.scene);
    for (const std::string& warning : first_few(given.warnings)) common.warn(warning);
    for (const std::string& note : first_few(given.notes)) common.note(note);
    const PortalFile& file = given.file;
    common.also_read(file.files);
    in.portals.insert(in.portals.end(), file.portals.begin(), file.portals.end());
    in.files.push_back({path, file.hash, file.provenance});
  }
  in.size = picture_size(in.camera, a.width, a.height);
  return in;
}

RenderSettings settings_of(const Arguments& a, const cli::Common& common) {
  RenderSettings settings;
  const bool unlimited = a.spp == 0 && a.seconds == 0 && a.target_error == 0;
  settings.spp = unlimited ? kSamples.at(common.quality) : static_cast<uint64_t>(a.spp);
  settings.target_error = a.target_error;
  settings.retry = a.retry;
  settings.seconds = a.seconds;
  settings.max_depth = a.max_depth == 0 ? kMaxDepth : static_cast<int>(a.max_depth);
  settings.beta = a.mis == "power" ? 2 : 1;
  settings.seed = common.seed;
  settings.quiet = common.quiet;
  settings.alpha = a.alpha;
  settings.layers = a.layers;
  settings.frames = !a.stats.empty();
  return settings;
}

std::string picture_bytes(const RenderResult& result,
                          std::map<std::string, std::string> attributes) {
  ExrFile exr;
  exr.picture = result.picture;
  exr.layers = result.layers;
  exr.attributes = std::move(attributes);
  return exr_bytes(exr);
}

void deliver(const Arguments& a, const cli::Common& common, const Loaded& in, const Choice& choice,
             const RenderSettings& settings, const RenderResult& result) {
  const Picture& picture = result.picture;
  cli::deliver(
      {{common.output,
        [&] {
          return picture_bytes(result, exr_attributes(choice.integrator, settings, result,
                                                      common.provenance(in.files)));
        }},
       {a.preview, [&] { return png_bytes(picture, auto_exposure(picture)); }},
       {a.nonzero, [&] { return png_bytes(nonzero_picture(picture), 0); }},
       {a.stats,
        [&] { return stats_json(choice.integrator, settings, result, in.portals) + "\n"; }}},
      common);
}

// Share of the light that segments through portals brought; 1 where none took part.
double share_of_portals(const World& world, const Integrator& integrator,
                        const RenderResult& result) {
  if (world.portals.empty() || !integrator.mixture.has(Technique::portal) || result.longest)
    return 1;
  const RenderTally& tally = result.tally;
  const double total = std::accumulate(tally.energy.begin(), tally.energy.end(), 0.0);
  return total > 0 ? tally.energy[static_cast<size_t>(Technique::portal)] / total : 1;
}

void report(const cli::Common& common, const Loaded& in, const World& world, const Choice& choice,
            const RenderSettings& settings, const RenderResult& result) {
  common.summary(summary_json(choice.integrator, settings, result, in.portals));
  for (const Tally::Place& place : result.tally.not_finite_at)
    common.warn(
        fmt::format("pixel {} {} sample {}: a contribution was not finite, or beyond what a splat "
                    "holds, and is left out",
                    place.x, place.y, place.sample));
  if (const double share =
          share_of_portals(world, choice.candidates[result.chosen].integrator, result);
      share < kLeastEnergy)
    common.note(idleness(in.portals, share));
  for (const std::string& sentence : disappointments(in.portals, result)) common.note(sentence);
  std::string name = choice.integrator.name;
  if (!result.chosen_label.empty()) name += " (" + result.chosen_label + ")";
  common.note(fmt::format("{}: {} samples per pixel at {} x {} in {:.1f} s ({:.1f} CPU s)", name,
                          result.spp, result.picture.width, result.picture.height, result.seconds,
                          result.cpu_seconds));
  if (const std::string length = length_sentence(settings, result); !length.empty())
    common.note(length);
  if (result.interrupted)
    common.note("stopped by a signal; the picture holds the samples named above");
  if (result.target) common.note(target_sentence(*result.target, result.spp));
}

int run(const Arguments& a, const cli::Common& common) {
  if (a.device != "cpu")
    throw Error(Exit::no_device, "--device gpu: this build renders on the CPU only");
  if (a.retry && a.target_error == 0) throw UsageError("--retry: needs --target-error");
  catch_signals();
  Loaded in = load(a, common);
  const Request request = request_of(a);
  const OpenWorld open = open_world(in.scene, in.camera, in.size.width, in.size.height, in.portals);
  if (open.uncovered > 0) common.warn(uncovered_sentence(open.uncovered, in.scene.frame));
  World& world = *open.world;
  const RenderSettings settings = settings_of(a, common);
  const Choice choice = choose(request, settings, in.camera, world, in.portals, common);
  const RenderResult result = render(world, choice.candidates, settings, choice.ways);
  if (request.automatic) common.note(choice_sentence(result));
  if (const std::string verdict = verdict_sentence(result); !verdict.empty()) common.note(verdict);
  deliver(a, common, in, choice, settings, result);
  report(common, in, world, choice, settings, result);
  common.explain_by([&] {
    return decisions_of({world, in.portals, request, choice, settings, result});
  });
  return static_cast<int>(result.interrupted ? Exit::interrupted : Exit::done);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
