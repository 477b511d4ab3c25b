#include "tools/tdpt-render/run/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

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

// The shared table of options lists the names used here.
constexpr bool names_are_those_of_the_table() {
  if (kIntegratorNames.size() != kIntegrators.size()) return false;
  for (size_t i = 0; i < kIntegrators.size(); ++i)
    if (std::string_view(kIntegratorNames[i]) != kIntegrators[i].name) return false;
  return true;
}
static_assert(names_are_those_of_the_table());
static_assert(std::string_view(kDenoisers[0]) == denoise::kKinds[0] &&
              std::string_view(kDenoisers[1]) == denoise::kKinds[1] &&
              std::string_view(kDenoisers[2]) == denoise::kKinds[2]);
static_assert(kMostEdges == kMaxDepth && kSmallestWalkShare == kFewestLightWalks);

// Samples per pixel if no option sets them.
constexpr cli::ByQuality<uint64_t> kSamples{4, 16, 64};

// The integrator with the numbers that were given, one at least.
Integrator with_numbers(const RenderArguments& a, Integrator guided) {
  const Mixture& row = guided.mixture;
  const auto refuse = [&](const char* option, const char* what) {
    throw UsageError(std::string(option) + ": " + guided.name + " " + what);
  };
  if (a.guide_light >= 0 && !row.techniques.walks_from_light())
    refuse("--set guide-light", "has no walks from the light");
  if (a.light_walks >= 0 && !row.techniques.walks_from_light())
    refuse("--set light-walks", "has no walks from the light");
  if (a.segments >= 0 && !row.has(Technique::portal))
    refuse("--set segments", "draws no portal segments");
  std::array<double, 2>& chance = guided.mixture.guiding.chance;
  if (a.guide_light >= 0) chance[0] = a.guide_light;
  if (a.guide_camera >= 0) chance[1] = a.guide_camera;
  if (a.segments >= 0) guided.mixture.segments = a.segments;
  if (a.light_walks >= 0) guided.mixture.light_walks = a.light_walks;
  return guided;
}

}  // namespace

std::vector<std::string> aovs_of(const RenderArguments& a) {
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
  if (a.retry > 0 && a.target_error == 0 && a.resume.empty())
    throw UsageError("--set retry: needs --target-error");
  if (a.add_samples > 0 && a.resume.empty())
    throw UsageError("--add-samples: needs --resume with the film of the picture");
  if (!a.shard.empty()) {
    check_stores_film(a, "--shard");
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
  job.limits.retry = a.retry > 0;
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
