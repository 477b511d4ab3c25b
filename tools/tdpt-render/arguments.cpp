#include "tools/tdpt-render/arguments.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/cli/cli.h"
#include "libcommon/cli/outputs.h"
#include "libcommon/film/film_file.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/features.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/walk.h"

namespace tdpt {
namespace {

void check_picture_name(const std::string& picture) {
  for (const char* suffix : {".png", ".jpg", ".jpeg"})
    if (picture.ends_with(suffix))
      throw UsageError("-o " + picture +
                       ": the picture is OpenEXR, name it .exr; --preview adds a PNG");
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) ==
         std::filesystem::weakly_canonical(b, ignored);
}

// How walks are directed at portals, and how many samples have which part.
void declare_guide_options(cli::Options& options, Arguments& a) {
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
}

// What makes a rendering last, or be one of many.
void declare_course_options(cli::Options& options, Arguments& a) {
  using Use = cli::Options::Use;
  options.side_output("--checkpoint", a.checkpoint,
                      "Keep what there is in FILE while rendering, for --resume");
  options.option("--checkpoint-every", a.checkpoint_every, "SECONDS",
                 "Time between checkpoints; default 60", 0, 1e9, cli::Shapes::nothing);
  options.file("--resume", a.resume, "Go on from a checkpoint, which is kept up to date", [&a] {
    if (a.checkpoint.empty()) return Use::written;
    return same_file(a.checkpoint, a.resume) ? Use::neither : Use::read;
  });
  options.option("--add-samples", a.add_samples, "N",
                 "With --resume: render N samples per pixel more than it was to have", 1,
                 int64_t{1} << 32, cli::Shapes::nothing);
  options.option("--shard", a.shard, "I/N",
                 "Render the I-th of N parts of the samples, from 0, for exrmerge",
                 cli::Shapes::nothing);
  options.file(
      "--plan", a.plan,
      "Write what is decided before rendering, and render only if -o is given. Obey it "
      "where it is there, for -o or --shard",
      [&] { return obeys_plan(a, options.common.output_given) ? Use::read : Use::written; });
  options.option("--print-shards", a.print_shards, "N",
                 "Print the commands of N shards, one a line", 1, 1 << 20, cli::Shapes::nothing);
  options.choice("--isa", a.isa, {"native", "avx2", "sse2"},
                 "Instructions to use: the newest, or those of older processors, too, for the same "
                 "bytes on each; default native",
                 cli::Shapes::nothing);
}

}  // namespace

std::vector<std::string> aovs_of(const Arguments& a) {
  std::vector<std::string> known(kFeatures.begin(), kFeatures.end()), names;
  known.insert(known.end(), kDerived.begin(), kDerived.end());
  if (a.aov == "all") return known;
  std::vector<std::string> given;
  for (size_t at = 0; at < a.aov.size();) {
    const size_t end = std::min(a.aov.find(',', at), a.aov.size());
    given.push_back(a.aov.substr(at, end - at));
    at = end + 1;
  }
  const auto has = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const std::string& name : given)
    if (!has(known, name))
      throw UsageError(fmt::format("--aov {}: '{}' given, expected some of {}, or all", a.aov, name,
                                   fmt::join(known, ",")));
  for (const std::string& name : known)
    if (has(given, name)) names.push_back(name);
  return names;
}

bool obeys_plan(const Arguments& a, bool output_given) {
  std::error_code ignored;
  return !a.plan.empty() &&
         (!a.shard.empty() || (output_given && std::filesystem::exists(a.plan, ignored)));
}

bool only_plans(const Arguments& a, bool output_given) {
  return !a.plan.empty() && a.shard.empty() && !output_given;
}

void declare_options(cli::Options& options, Arguments& a) {
  using cli::Shapes;
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  options.inputs("--portal", a.portals, "FILE",
                 "Portals (.glb, .gltf) from portalfit or a modelling program; may be repeated");
  std::vector<std::string> names{"auto"};
  for (const Integrator& integrator : kIntegrators) names.push_back(integrator.name);
  options.choice("--integrator", a.integrator, names,
                 "Techniques to combine; default auto, which finds the best for this scene");
  declare_guide_options(options, a);
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
  options.option("--width", a.width, "W",
                 "Width in pixels; default from --height, else as the scene says, else 640", 1,
                 65536);
  options.option("--height", a.height, "H",
                 "Height in pixels; default as the scene says, else from the camera's aspect", 1,
                 65536);
  declare_sky_options(options, a.sky);
  declare_camera_options(options, a.camera);
  options.choice("--mis", a.mis, {"balance", "power"}, "MIS heuristic; default balance");
  declare_device_options(options, a.device, "Where to render");
  declare_course_options(options, a);
  options.side_output("--stats", a.stats, "Write statistics as JSON, with the picture's progress");
  options.flag("--alpha", a.alpha,
               "Transparent film: leave out the sky behind all, add a channel A of what is before "
               "it");
  options.flag("--layers", a.layers,
               "Add each technique's contribution as layers <technique>.R .G .B");
  options.option("--aov", a.aov, "LIST",
                 "Add channels: albedo, normal, position, depth, variance, samples, or all");
  options.side_output("--nonzero", a.nonzero,
                      "Write a PNG of the pixels: red with a contribution, green without");
  options.output_beside("--preview", a.preview, cli::png_beside, "Write a PNG beside the picture");
  options.result_name(check_picture_name);
  const cli::Common& common = options.common;
  options.result_is_text([&] { return a.print_shards > 0 || only_plans(a, common.output_given); });
}

}  // namespace tdpt
