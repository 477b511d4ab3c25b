#include "tools/tdpt-render/arguments.h"

#include "libcommon/base/error.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/walk.h"

namespace tdpt {
namespace {

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

}  // namespace

void declare_options(cli::Options& options, Arguments& a) {
  using cli::Shapes;
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  options.inputs("--portal", a.portals, "FILE",
                 "Portals (.glb, .gltf) from portalfit or a modelling program; may be repeated");
  std::vector<std::string> names{"auto"};
  for (const Integrator& integrator : kIntegrators) names.push_back(integrator.name);
  options.choice("--integrator", a.integrator, names,
                 "Techniques to combine; default auto, which finds the best for this scene");
  options.option(
      "--guide-light", a.guide_light, "Q",
      "Probability that a light walk aims at a portal; default 0.7 with tdpt-guided, else 0", 0,
      0.95);
  options.option(
      "--guide-camera", a.guide_camera, "Q",
      "Probability that a camera walk aims at a portal; default 0.4 with tdpt-guided, else 0", 0,
      0.95);
  options.option(
      "--segments", a.segments, "SHARE",
      "Share of the samples that draw a portal segment; default 1, with tdpt-guided 0.25", 0.01, 1);
  options.option(
      "--light-walks", a.light_walks, "SHARE",
      "Share of the samples that make a light walk; default 0.25 with tdpt-guided, else 1",
      kFewestLightWalks, 1);
  options.quality();
  options.option("--spp", a.spp, "N",
                 "Samples per pixel; default 16 (draft 4, high 64), or as --time allows or "
                 "--target-error takes",
                 1, int64_t{1} << 32);
  options.option("--time", a.seconds, "SECONDS", "Stop rendering after this wall-clock time", 1e-3,
                 1e9, Shapes::nothing);
  options.option("--target-error", a.target_error, "E",
                 "Render until the relMSE is E, within --spp and --time; the number of samples is "
                 "fixed beforehand",
                 1e-9, 1e9);
  options.flag("--retry", a.retry, "Where the target seems to be missed, render on once");
  options.option("--max-depth", a.max_depth, "K", "Edges of the longest path; default no limit", 1,
                 kMaxDepth);
  options.option("--width", a.width, "W", "Width in pixels; default 640, or from --height", 1,
                 65536);
  options.option("--height", a.height, "H", "Height in pixels; default from the camera's aspect", 1,
                 65536);
  declare_sky_options(options, a.sky);
  options.option("--camera", a.camera, "NAME", "Camera to render; default the first");
  options.choice("--mis", a.mis, {"balance", "power"}, "MIS heuristic; default balance");
  options.choice("--device", a.device, {"cpu", "gpu"}, "Where to render; default cpu");
  options.side_output("--stats", a.stats, "Write statistics as JSON, with the picture's progress");
  options.flag("--alpha", a.alpha,
               "Transparent film: leave out the sky behind all, add a channel A of what is before "
               "it");
  options.flag("--layers", a.layers,
               "Add each technique's contribution as layers <technique>.R .G .B");
  options.side_output("--nonzero", a.nonzero,
                      "Write a PNG of the pixels: red with a contribution, green without");
  options.output_beside("--preview", a.preview, preview_path, "Write a PNG beside the picture");
  options.result_name(check_picture_name);
}

}  // namespace tdpt
