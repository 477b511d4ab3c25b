// tdpt-render: renders a scene, with portals if there are any.
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/portal_probe.h"
#include "tools/tdpt-render/portal_report.h"
#include "tools/tdpt-render/report.h"

namespace tdpt {
namespace {

struct Arguments {
  std::string scene, camera, integrator = "default", mis = "balance", device = "cpu", stats,
                             nonzero, preview;
  std::vector<std::string> portals;
  int64_t spp = 0, max_depth = 6, width = 0, height = 0;
  double guide_light = -1, guide_camera = -1, segments = -1;
  double seconds = 0;
  bool layers = false, verbose = false;
};

// Fills in what --width and --height leave open: square pixels, the camera's aspect, 640 wide.
void choose_size(const Camera& camera, int64_t& width, int64_t& height) {
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const auto at_least_1 = [](double v) { return std::llround(std::clamp(v, 1.0, 1e6)); };
  if (width == 0 && height == 0) width = 640;
  if (width == 0) width = at_least_1(static_cast<double>(height) * aspect);
  if (height == 0) height = at_least_1(static_cast<double>(width) / aspect);
  if (width > 65536 || height > 65536 || width * height > (int64_t{1} << 27))
    throw UsageError(fmt::format(
        "a picture of {} x {} pixels is too large, at most 134217728 pixels", width, height));
}

// Where --preview goes: beside the picture, under its name with .png.
std::string preview_path(const std::string& picture) {
  if (picture == "-") throw UsageError("--preview puts a PNG beside the picture: give -o FILE");
  const size_t dot = picture.find_last_of('.');
  const size_t slash = picture.find_last_of('/');
  const bool has_suffix = dot != std::string::npos && (slash == std::string::npos || dot > slash);
  return (has_suffix ? picture.substr(0, dot) : picture) + ".png";
}

void check_picture_name(const std::string& picture) {
  for (const char* suffix : {".png", ".jpg", ".jpeg"})
    if (picture.ends_with(suffix))
      throw UsageError("-o " + picture +
                       ": the picture is OpenEXR, name it .exr; --preview adds a PNG");
}

// Every edge of a path is tested against every triangle of the portals, and places are held in
// single precision by the tracer: a whole scene given as a portal by mistake is told so.
void check_portals(const std::string& path, const std::vector<Portal>& portals,
                   const Frame& frame) {
  constexpr size_t kMostTriangles = 4096;
  size_t triangles = 0;
  for (const Portal& portal : portals) {
    triangles += portal.triangles.size();
    for (const Vec3d& v : portal.vertices)
      if (!(length(frame.to_canonical(v)) <= 1e6))
        throw InputError(display_name(path), portal.name,
                         "lies more than a million times the scene's size away");
  }
  if (triangles > kMostTriangles)
    throw InputError(display_name(path), "",
                     fmt::format("has {} triangles, expected a portal of at most {}", triangles,
                                 kMostTriangles));
}

int run(const Arguments& a, const cli::Common& common) {
  if (a.device != "cpu")
    throw Error(Exit::no_device, "--device gpu: this build renders on the CPU only");
  catch_signals();

  const Scene scene = read_gltf(a.scene);
  for (const std::string& warning : scene.warnings) common.warn(warning);
  const Camera& camera = scene.camera(a.camera);
  std::vector<cli::Common::Input> inputs{{a.scene, scene.hash, {}}};
  std::vector<Portal> portals;
  for (const std::string& path : a.portals) {
    PortalFile file = read_portals(path);
    if (!file.scene_hash.empty() && file.scene_hash != scene.hash)
      throw InputError(display_name(path), "", "was made from another scene than " + a.scene);
    check_portals(path, file.portals, scene.frame);
    if (file.portals.empty()) common.warn("there is no portal in " + display_name(path));
    portals.insert(portals.end(), file.portals.begin(), file.portals.end());
    inputs.push_back({path, file.hash, file.provenance});
  }

  int64_t width = a.width, height = a.height;
  choose_size(camera, width, height);

  RenderSettings settings;
  settings.spp = a.spp == 0 && a.seconds == 0 ? 16 : static_cast<uint64_t>(a.spp);
  settings.seconds = a.seconds;
  settings.max_depth = static_cast<int>(a.max_depth);
  settings.beta = a.mis == "power" ? 2 : 1;
  settings.seed = common.seed;
  settings.quiet = common.quiet;
  settings.layers = a.layers;
  settings.frames = !a.stats.empty();
  const World world(scene, camera, static_cast<int>(width), static_cast<int>(height), portals);
  const bool choose = a.integrator == "auto" || (a.integrator == "default" && !portals.empty());
  Integrator named = choose || a.integrator == "default" ? bdpt : integrator_named(a.integrator);
  Integrator guided = tdpt_guided;
  std::vector<Integrator> to_try(kGuided.begin(), kGuided.end());
  if (a.guide_light >= 0 || a.guide_camera >= 0 || a.segments >= 0) {
    if (!choose && named.mixture.guiding == Guiding{})
      throw UsageError(std::string("--guide-light, --guide-camera, --segments: ") + named.name +
                       " has none of them");
    std::array<double, 2>& chance = guided.mixture.guiding.chance;
    if (a.guide_light >= 0) chance[0] = a.guide_light;
    if (a.guide_camera >= 0) chance[1] = a.guide_camera;
    if (a.segments >= 0) guided.mixture.segments = a.segments;
    if (!choose) named = guided;
    to_try = {guided};
  }
  if (world.portals.empty() && named.mixture.has(Technique::portal))
    common.warn("no portal is given, so no path is sampled through one");
  if (choose || named.mixture.has(Technique::portal)) {
    probe(world, portals);
    for (const std::string& promise : promises(portals)) common.note(promise);
  }
  const std::vector<Candidate> candidates = choose
                                                ? auto_candidates(world, portals, to_try)
                                                : std::vector<Candidate>{{named, label_of(named)}};
  const Integrator integrator = choose ? either_of(candidates) : named;
  if (const std::string missed = light_missed(integrator, scene); !missed.empty())
    common.warn(missed);
  if (world.lights.empty()) common.warn("nothing in the scene emits light: the picture is black");
  const RenderResult result = render(world, candidates, settings);
  if (choose) common.note(choice_sentence(result, portals));

  ExrFile exr;
  exr.picture = result.picture;
  exr.layers = result.layers;
  exr.attributes = exr_attributes(integrator, settings, result, common.provenance(inputs));
  write_output(common.output, exr_bytes(exr));
  if (!a.preview.empty())
    write_output(a.preview, png_bytes(result.picture, auto_exposure(result.picture)));
  if (!a.nonzero.empty()) write_output(a.nonzero, png_bytes(nonzero_picture(result.picture), 0));
  if (!a.stats.empty())
    write_output(a.stats, stats_json(integrator, settings, result, portals) + "\n");
  common.summary(summary_json(integrator, settings, result, portals));
  for (const Tally::Place& place : result.tally.not_finite_at)
    common.warn(
        fmt::format("pixel {} {} sample {}: a contribution was not finite, or beyond what a splat "
                    "holds, and is left out",
                    place.x, place.y, place.sample));
  const double total = std::accumulate(result.tally.energy.begin(), result.tally.energy.end(), 0.0);
  if (!world.portals.empty() &&
      candidates[result.chosen].integrator.mixture.has(Technique::portal) &&
      result.tally.energy[static_cast<size_t>(Technique::portal)] < 0.01 * total)
    common.note(
        "the portals brought less than 1 % of the light: do their fronts face the camera's room?");
  for (const std::string& sentence : disappointments(portals, result)) common.note(sentence);
  const std::string name = choose ? "auto (" + result.chosen_label + ")" : std::string(named.name);
  common.note(fmt::format("{}: {} samples per pixel at {} x {} in {:.1f} s ({:.1f} CPU s)", name,
                          result.spp, width, height, result.seconds, result.cpu_seconds));
  if (a.verbose)
    for (const std::string& note : verbose_notes(scene, integrator, result)) common.note(note);
  if (!result.interrupted) return 0;
  common.note("stopped by a signal; the picture holds the samples named above");
  return static_cast<int>(Exit::interrupted);
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  using namespace tdpt;
  Arguments a;
  cli::Options options("tdpt-render",
                       "Renders a glTF scene by (tri-directional) path tracing, with portals where "
                       "there are any.",
                       "Picture to write (OpenEXR); default standard output");
  using cli::Shapes;
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  options.inputs("--portal", a.portals, "FILE",
                 "Portals (.glb, .gltf) from portalfit or a modelling program; may be repeated");
  std::vector<std::string> names{"auto"};
  for (const Integrator& integrator : kIntegrators) names.push_back(integrator.name);
  options.choice("--integrator", a.integrator, names,
                 "Techniques to combine; default auto with portals, bdpt without");
  options.option("--guide-light", a.guide_light, "Q",
                 "tdpt-guided: probability that a light walk aims at a portal; default 0.5", 0,
                 0.95);
  options.option("--guide-camera", a.guide_camera, "Q",
                 "tdpt-guided: probability that a camera walk aims at a portal; default 0.4", 0,
                 0.95);
  options.option("--segments", a.segments, "SHARE",
                 "tdpt-guided: share of the samples that draw a portal segment; default 1", 0.01,
                 1);
  options.option("--spp", a.spp, "N", "Samples per pixel; default 16, or as --time allows", 1,
                 int64_t{1} << 32);
  options.option("--time", a.seconds, "SECONDS", "Stop rendering after this wall-clock time", 1e-3,
                 1e9, Shapes::nothing);
  options.option("--max-depth", a.max_depth, "K", "Edges of the longest path; default 6", 1,
                 kMaxDepth);
  options.option("--width", a.width, "W", "Width in pixels; default 640, or from --height", 1,
                 65536);
  options.option("--height", a.height, "H", "Height in pixels; default from the camera's aspect", 1,
                 65536);
  options.option("--camera", a.camera, "NAME", "Camera to render; default the first");
  options.choice("--mis", a.mis, {"balance", "power"}, "MIS heuristic; default balance");
  options.choice("--device", a.device, {"cpu", "gpu"}, "Where to render; default cpu");
  options.side_output("--stats", a.stats, "Write statistics as JSON, with the picture's progress");
  options.flag("--layers", a.layers,
               "Add each technique's contribution as layers <technique>.R .G .B");
  options.side_output("--nonzero", a.nonzero,
                      "Write a PNG of the pixels: red with a contribution, green without");
  options.output_beside("--preview", a.preview, preview_path, "Write a PNG beside the picture");
  options.result_name(check_picture_name);
  options.flag("--verbose", a.verbose,
               "Say what the scene needs, what was left out, rays and techniques' shares",
               Shapes::nothing);
  return options.run_main(argc, argv, [&] { return run(a, options.common); });
}
