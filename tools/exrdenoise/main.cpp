// exrdenoise: filters the noise of a picture by the buffers that tdpt-render puts beside it.
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"

namespace tdpt {
namespace {

constexpr cli::Program kProgram{
    "exrdenoise",
    "Filters the noise of a rendered picture. The result is smoother, but no longer unbiased.",
    "Picture to write (OpenEXR); default standard output",
    cli::Result::binary,
    cli::kLibraries,
    cli::kCommit,
    cli::kThreads | cli::kQuiet};

struct Arguments : PictureArguments {
  std::string picture, previous, next, denoiser = denoise::kKinds[0];
};

void declare_options(cli::Options& options, Arguments& a) {
  options.argument("picture", a.picture,
                   "Picture with the channels of --aov halves,albedo,normal,depth (.exr); - is "
                   "standard input");
  options.input(
      "--previous", a.previous, "FILE",
      "The frame before, of a moving picture, with the same channels: less noise, and less "
      "flicker");
  options.input("--next", a.next, "FILE", "The frame after it");
  options.choice("--denoiser", a.denoiser, {denoise::kKinds.begin(), denoise::kKinds.end()},
                 "Filter: regression, our own; oidn, Intel's Open Image Denoise; default auto, our "
                 "own with the help of the other where it is installed");
  declare_picture_options(options, a);
}

// One JSON object, the keys of tdpt-json(5). `exposure`: of the preview, if there is one.
std::string summary_json(const Picture& picture, const denoise::Filtered& filtered, double seconds,
                         std::optional<double> exposure) {
  const Vec3d mean = mean_of(picture);
  nlohmann::ordered_json j{{"width", picture.width},
                           {"height", picture.height},
                           {"mean", {mean.x, mean.y, mean.z}},
                           {"denoiser", filtered.denoiser},
                           {"outliers", filtered.outliers},
                           {"left_out", filtered.left_out},
                           {"seen_elsewhere", filtered.seen_elsewhere},
                           {"features", filtered.has_features},
                           {"seconds", seconds}};
  if (const auto& left = filtered.left) {
    j["relmse"] = left->relmse;
    j["interval"] = {left->low, left->high};
  }
  if (exposure) j["exposure"] = *exposure;
  return j.dump();
}

int run(const Arguments& a, const cli::Common& common) {
  check_picture_arguments(a);
  const denoise::Kind kind = denoise::kind_of(a.denoiser);
  if (kind == denoise::Kind::oidn && !(a.previous.empty() && a.next.empty()))
    throw UsageError("--previous and --next do not go with --denoiser oidn");
  PictureInput frame = read_picture(a.picture, common, denoise::parse_with_channels);
  ExrFile& file = frame.file;
  const std::string& name = frame.name;
  std::vector<denoise::NamedPicture> others;
  std::vector<cli::Common::Input> sources{frame.source};
  for (const std::string& path : {a.previous, a.next}) {
    if (path.empty()) continue;
    PictureInput other = read_picture(path, common, denoise::parse_with_channels);
    others.push_back({std::move(other.file), other.name});
    sources.push_back(other.source);
  }
  const auto start = std::chrono::steady_clock::now();
  const denoise::Filtered filtered = denoise::filter_picture(file, name, kind, others);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  set_provenance(file, common.provenance(sources));
  // It is another picture than the one that tdpt-render knows by this mark.
  if (const auto mark = file.attributes.find(kFrameAttribute); mark != file.attributes.end())
    mark->second += " filtered";
  const std::optional<double> exposure = exposure_of(file.picture, a.preview, a.exposure);
  cli::deliver({{common.output, [&] { return exr_bytes(file); }},
                {a.preview, [&] { return preview_bytes(file.picture, *exposure); }}},
               common);
  if (common.json) common.summary(summary_json(file.picture, filtered, took.count(), exposure));
  if (!filtered.has_features)
    common.warn(name + ": has no albedo, normal and depth: edges of textures and things may blur");
  common.note(fmt::format("{}; {:.1f} s", denoise::sentence_of(filtered), took.count()));
  return 0;
}

}  // namespace
}  // namespace tdpt

int main(int argc, char** argv) {
  return tdpt::cli::run_program(argc, argv, tdpt::kProgram, tdpt::declare_options, tdpt::run);
}
