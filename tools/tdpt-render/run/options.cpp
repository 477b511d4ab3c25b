#include "tools/tdpt-render/run/options.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/integrators/features.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/walk.h"

namespace tdpt {
namespace {

static_assert(kMostEdges == kMaxDepth && kSmallestWalkShare == kFewestLightWalks);

// Samples per pixel if no option sets them.
constexpr cli::ByQuality<uint64_t> kSamples{4, 16, 64};

// The integrator with the numbers that were given, one at least.
Integrator with_numbers(const RenderArguments& a, Integrator guided) {
  Mixture& row = guided.mixture;
  const bool walks = row.techniques.walks_from_light();
  const auto take = [&](const char* option, double given, bool applies, double& number) {
    if (given >= 0 && !applies)
      throw UsageError(
          fmt::format("{}: {} {}", option, guided.name,
                      walks ? "draws no portal segments" : "has no walks from the light"));
    if (given >= 0) number = given;
  };
  take("--set guide-light", a.guide_light, walks, row.guiding.chance[0]);
  take("--set guide-camera", a.guide_camera, true, row.guiding.chance[1]);
  take("--set segments", a.segments, row.has(Technique::portal), row.segments);
  take("--set light-walks", a.light_walks, walks, row.light_walks);
  return guided;
}

}  // namespace

std::vector<std::string> aovs_of(const RenderArguments& a) {
  std::vector<std::string> known(kFeatures.begin(), kFeatures.end()), names;
  known.insert(known.end(), kDerived.begin(), kDerived.end());
  if (a.aov == "all") return known;
  std::set<std::string> given;
  std::istringstream list(a.aov);
  for (std::string name; std::getline(list, name, ',');) given.insert(name);
  for (const std::string& name : known)
    if (given.erase(name) > 0) names.push_back(name);
  if (!given.empty())
    throw UsageError(fmt::format("--aov {}: '{}' given, expected some of {}, or all", a.aov,
                                 *given.begin(), fmt::join(known, ",")));
  return names;
}

bool keeps_halves(const RenderArguments& a) {
  const std::vector<std::string> aovs = aovs_of(a);
  return (a.filters() && a.denoiser != kDenoisers.back()) ||
         std::any_of(aovs.begin(), aovs.end(), [](const std::string& name) {
           return name == "variance" || name == "halves";
         });
}

SampleRange samples_of_shard(const std::string& shard, uint64_t samples) {
  uint64_t index = 0, of = 1;
  const char* const end = shard.data() + shard.size();
  const auto first = std::from_chars(shard.data(), end, index);
  const bool is_pair = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = is_pair ? std::from_chars(first.ptr + 1, end, of) : first;
  if (!is_pair || second.ec != std::errc() || second.ptr != end || index >= of || of > 1 << 20)
    throw UsageError("--shard " + shard + ": expected I/N with I from 0 to N - 1, N up to 1048576");
  const auto at = [&](uint64_t i) {
    return static_cast<uint64_t>(static_cast<unsigned __int128>(samples) * i / of);
  };
  return {at(index), at(index + 1) - at(index)};
}

void check_options(const RenderArguments& a) {
  check_render_arguments(a);
  if (a.checkpoint_every >= 0 && a.checkpoint.empty() && a.resume.empty())
    throw UsageError("--set checkpoint-every: needs --checkpoint or --resume");
  if (a.add_samples > 0 && a.resume.empty())
    throw UsageError("--add-samples: needs --resume with the film of the picture");
  if (!a.shard.empty()) {
    samples_of_shard(a.shard, 0);  // throws
    if (a.seconds > 0 || a.target_error > 0 || (a.spp == 0 && a.resume.empty()))
      throw UsageError(
          "--shard: needs --spp, and neither --time nor --target-error: all parts "
          "must know how many samples the picture has");
  }
}

Job job_of(const RenderArguments& a, const cli::Common& common) {
  Job job;
  const bool unlimited = a.spp == 0 && a.seconds == 0 && a.target_error == 0;
  job.limits.spp = unlimited ? kSamples.at(common.quality) : static_cast<uint64_t>(a.spp);
  job.limits.target_error = a.target_error;
  job.limits.seconds = a.seconds;
  job.automatic = a.integrator == "auto";
  job.named = job.automatic ? bdpt : integrator_named(a.integrator);
  if (a.guide_light >= 0 || a.guide_camera >= 0 || a.segments >= 0 || a.light_walks >= 0) {
    job.guided = with_numbers(a, job.automatic ? tdpt_guided : job.named);
    if (!job.automatic) job.named = job.guided;
  }
  job.max_depth = a.max_depth == 0 ? kMaxDepth : static_cast<int>(a.max_depth);
  job.beta = a.mis == "power" ? 2 : 1;
  job.seed = common.seed;
  job.quiet = common.quiet;
  job.alpha = a.alpha;
  job.layers = a.layers;
  job.halves = keeps_halves(a);
  job.frames = !a.stats.empty();
  return job;
}

void declare_options(cli::Options& options, RenderArguments& a) {
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  declare_render_options(options, a);
  options.part(cli::Part::lasting);
  options.option("--shard", a.shard, "I/N",
                 "Render the I-th of N parts of the samples, from 0, for exrmerge",
                 cli::Effect::report);
  declare_device_options(options, a.device, "Where to render");
  options.flag("--check", a.check, "Check the options, the scene and what else is read, and exit",
               cli::Effect::report);
}

}  // namespace tdpt
