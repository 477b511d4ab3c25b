// How --resume and --shard affect a rendering: where it begins, and which samples it has.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "libcommon/options/render_options.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/run/progress.h"

namespace tdpt {

/// Throws UsageError for a checkpoint that would be overwritten.
void check_checkpoint(const RenderArguments& a);
/// Makes `progress` that of the part, where there is --shard.
void take_part(const RenderArguments& a, Progress& progress);

/// A picture that was begun before.
struct Begun {
  Plan plan;
  std::shared_ptr<Progress> progress;  ///< with the limits and the goal of this run
  std::map<std::string, std::string> attributes;
  std::string processor;  ///< whose code rendered it so far
};
/// Reads the film of --resume; nothing if none is to be resumed. `is_of`: what determines this
/// picture. Throws UsageError or InputError if they do not belong together.
std::optional<Begun> read_begun(const RenderArguments& a, const Fingerprint& is_of,
                                const Vista& vista);

/// Explains why a film rendered by the code `before` changes when resumed by that of `now`.
std::string other_code_sentence(const std::string& file, const std::string& before,
                                const std::string& now);

}  // namespace tdpt
