#include "tools/tdpt-render/run/arguments.h"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/cli/cli.h"
#include "libcommon/film/film_file.h"
#include "libcommon/gpu/device_options.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/walk.h"
#include "tools/tdpt-render/run/features.h"

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

// Options of a rendering that is one of several parts.
void declare_shard_options(cli::Options& options, Arguments& a) {
  using Use = cli::Options::Use;
  options.part(cli::Part::lasting);
  options.option("--shard", a.shard, "I/N",
                 "Render the I-th of N parts of the samples, from 0, for exrmerge; all/N prints "
                 "the commands of all, one a line",
                 cli::Effect::told);
  options.file(
      "--plan", a.plan,
      "Write what is decided before rendering, and render only if -o is given. Obey it "
      "where it is there, for -o or --shard",
      [&] { return obeys_plan(a, options.common.output_given) ? Use::read : Use::written; });
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

bool keeps_halves(const Arguments& a) {
  const std::vector<std::string> aovs = aovs_of(a);
  return (a.filters() && a.denoiser != kDenoisers.back()) ||
         std::any_of(aovs.begin(), aovs.end(), [](const std::string& name) {
           return name == "variance" || name == "halves";
         });
}

bool prints_shards(const Arguments& a) {
  return a.shard.starts_with("all/");
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
  options.argument("scene", a.scene, "Scene (.glb, .gltf); - is standard input");
  declare_render_options(options, a);
  declare_shard_options(options, a);
  declare_device_options(options, a.device, "Where to render");
  options.flag("--check", a.check, "Check the options, the scene and what else is read, and exit",
               cli::Effect::told);
  const cli::Common& common = options.common;
  options.result_is_text([&] { return prints_shards(a) || only_plans(a, common.output_given); });
}

}  // namespace tdpt
