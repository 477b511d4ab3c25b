#include "libcommon/options/render_options.h"

#include <filesystem>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"

namespace tdpt {
namespace {

using cli::Effect;

void check_picture_name(const std::string& picture) {
  for (const char* suffix : {".png", ".jpg", ".jpeg"})
    if (suffix_of(picture) == suffix)
      throw UsageError("-o " + picture +
                       ": the picture is OpenEXR, name it .exr; --preview adds a PNG");
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return std::filesystem::weakly_canonical(a, ignored) ==
         std::filesystem::weakly_canonical(b, ignored);
}

// Devices and pipes may have any name.
void check_name_of_png(const std::string& option, const std::string& path) {
  std::error_code ignored;
  if (!path.empty() && suffix_of(path) != ".png" && !std::filesystem::is_other(path, ignored))
    throw UsageError(option + "=" + path + ": the picture is a PNG, name it .png");
}

void check_no_portal_twice(const std::vector<std::string>& portals) {
  std::error_code ignored;
  for (size_t i = 0; i < portals.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (same_file(portals[i], portals[j]) ||
          std::filesystem::equivalent(portals[i], portals[j], ignored))
        throw UsageError("--portal " + portals[i] + ": is given twice" +
                         (portals[i] == portals[j] ? "" : ", before as " + portals[j]));
}

// Guiding towards portals, shares of samples, and weighting.
void declare_mixture_options(cli::Options& options, RenderArguments& a) {
  options.option(
      "--set guide-light", a.guide_light, "Q",
      "Probability that a light walk aims at a portal; default 0.5 with tdpt-guided, else 0", 0,
      0.95);
  options.option(
      "--set guide-camera", a.guide_camera, "Q",
      "Probability that a camera walk aims at a portal; default 0.4 with tdpt-guided, else 0", 0,
      0.95);
  options.option(
      "--set segments", a.segments, "SHARE",
      "Share of the samples that draw a portal segment; default 1, with tdpt-guided 0.25", 0.01, 1);
  options.option(
      "--set light-walks", a.light_walks, "SHARE",
      "Share of the samples that make a light walk; default 0.25 with tdpt-guided, else 1",
      kSmallestWalkShare, 1);
  options.choice("--set mis", a.mis, {"balance", "power"}, "MIS heuristic; default balance");
}

// Checkpoints.
void declare_checkpoint_options(cli::Options& options, RenderArguments& a) {
  using Use = cli::Options::Use;
  options.part(cli::Part::lasting);
  options.side_output("--checkpoint", a.checkpoint,
                      "Keep what there is in FILE while rendering, for --resume");
  options.option("--set checkpoint-every", a.checkpoint_every, "SECONDS",
                 "Time between checkpoints; default 60", 0, 1e9, Effect::speed);
  options.file("--resume", a.resume, "Go on from a checkpoint, which is kept up to date", [&a] {
    if (a.checkpoint.empty()) return Use::written;
    return same_file(a.checkpoint, a.resume) ? Use::neither : Use::read;
  });
  options.option("--add-samples", a.add_samples, "N",
                 "With --resume: render N samples per pixel more than it was to have", 1,
                 int64_t{1} << 32, Effect::stored);
  options.choice("--set isa", a.isa, {"native", "avx2", "sse2"},
                 "Instructions to use: the newest, or those of older processors, too, for the same "
                 "bytes on each; default native",
                 Effect::stored);
}

// Amount of rendering.
void declare_amount_options(cli::Options& options, RenderArguments& a) {
  options.part(cli::Part::effort);
  options.quality(Effect::samples);
  options.option("--time", a.seconds, "SECONDS", "Stop rendering after this wall-clock time", 1e-3,
                 1e9, Effect::stored);
  options.option("--spp", a.spp, "N",
                 "Samples per pixel; default 16 (draft 4, high 64), or as --time allows or "
                 "--target-error takes",
                 1, int64_t{1} << 32, Effect::samples);
  options.option("--target-error", a.target_error, "E",
                 "Render until the relMSE is E, within --spp and --time; the number of samples is "
                 "fixed beforehand",
                 1e-9, 1e9, Effect::samples);
  options.option("--width", a.width, "W",
                 "Width in pixels; default from --height, else as the scene says, else 640", 1,
                 65536);
  options.option("--height", a.height, "H",
                 "Height in pixels; default as the scene says, else from the camera's aspect", 1,
                 65536);
  std::vector<std::string> names{"auto"};
  names.insert(names.end(), kIntegratorNames.begin(), kIntegratorNames.end());
  options.choice("--integrator", a.integrator, names,
                 "Techniques to combine; default auto, which finds the best for this scene");
  declare_mixture_options(options, a);
  options.option("--max-depth", a.max_depth, "K", "Edges of the longest path; default no limit", 1,
                 kMostEdges);
}

// Contents of the picture besides its colours.
void declare_channel_options(cli::Options& options, RenderArguments& a) {
  options.part(cli::Part::picture);
  options.flag("--alpha", a.alpha,
               "Transparent film: leave out the sky behind all, add a channel A of what is before "
               "it");
  options.flag("--layers", a.layers,
               "Add each technique's contribution as layers <technique>.R .G .B");
  options.option("--aov", a.aov, "LIST",
                 "Add channels: albedo, normal, position, depth, variance, halves, samples, or all",
                 Effect::samples);
  options.flag("--denoise", a.denoise,
               "Filter the noise, with a bias that more samples reduce; add what was rendered as "
               "noisy.R .G .B",
               Effect::samples);
  options.choice(
      "--denoiser", a.denoiser, {kDenoisers.begin(), kDenoisers.end()},
      "Filter it by this: regression, our own; oidn, Intel's Open Image Denoise; default auto, "
      "our own with the help of the other where it is installed",
      Effect::samples);
}

}  // namespace

void check_render_arguments(const RenderArguments& a) {
  check_picture_arguments(a);
  check_shot(a.shot, a.pose);
  check_lens(a.lens, a.shot, a.pose, a.device);
  if (a.filters() && a.denoiser != kDenoisers.back() && a.spp == 1)
    throw UsageError("--denoise needs two samples per pixel or more: --spp 1 given");
  check_name_of_png("--set nonzero", a.nonzero);
  check_no_portal_twice(a.portals);
}

void declare_render_options(cli::Options& options, RenderArguments& a) {
  options.part(cli::Part::files);
  options.inputs("--portal", a.portals, "FILE",
                 "Portals (.glb, .gltf) from portalfit or a modelling program; may be repeated");
  declare_picture_options(options, a);
  options.result_name(check_picture_name);
  declare_amount_options(options, a);
  declare_channel_options(options, a);
  declare_camera_options(options, a.camera);
  declare_lens_options(options, a.lens);
  declare_pose_options(options, a.pose);
  declare_shot_options(options, a.shot, Effect::samples);
  declare_sky_options(options, a.sky);
  declare_checkpoint_options(options, a);
  options.part(cli::Part::telling);
  options.side_output("--stats", a.stats, "Write statistics as JSON, with the picture's progress");
  options.side_output("--set nonzero", a.nonzero,
                      "Write a PNG of the pixels: red with a contribution, green without");
}

}  // namespace tdpt
