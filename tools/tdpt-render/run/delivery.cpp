#include "tools/tdpt-render/run/delivery.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <new>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/formats/tone.h"
#include "tools/tdpt-render/integrators/features.h"
#include "tools/tdpt-render/run/checkpoint.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt {
namespace {

// Value of kFrameAttribute for a frame that a signal interrupted.
constexpr const char* kIncomplete = "incomplete";

constexpr double kPreviewEvery = 5, kCheckpointEvery = 60;  // seconds

// Red where a pixel got some contribution, green where it is black.
std::string nonzero_png(const Picture& picture) {
  Picture marks{picture.width, picture.height, {}};
  marks.pixels.reserve(picture.pixels.size());
  for (const Rgb& p : picture.pixels)
    marks.pixels.push_back(p != Rgb{} ? Rgb{1, 0, 0} : Rgb{0, 1, 0});
  return png_bytes(marks);
}

// Where a picture is kept after a failed write.
std::string kept_sentence(const std::string& output, const std::string& bytes) {
  const std::string path = keep_elsewhere(output == "-" ? "picture.exr" : output, bytes);
  return path.empty() ? "the picture is lost" : "the picture is kept in " + path;
}

}  // namespace

std::vector<std::string> derived_of(const RenderArguments& a) {
  std::vector<std::string> derived;
  for (const std::string& name : aovs_of(a))
    if (std::find(kDerived.begin(), kDerived.end(), name) != kDerived.end())
      derived.push_back(name);
  if (a.filters())
    derived.push_back(denoise::kDenoised[static_cast<size_t>(denoise::kind_of(a.denoiser))]);
  return derived;
}

Channels channels_of(const RenderArguments& a, const Vista& vista, uint64_t seed) {
  std::vector<std::string> names = aovs_of(a);
  if (a.filters()) names.insert(names.end(), {"albedo", "normal", "depth"});
  return features(vista, names, seed);
}

bool Delivery::save(const Plan& plan, Progress& progress, const Channels& channels) const {
  std::string why;
  try {
    write_output(checkpoint(), film_bytes(progress, plan, facts_, channels));
    return true;
  } catch (const OutputError& e) {
    why = e.what();
  } catch (const std::bad_alloc&) {
    why = checkpoint() + ": there is no memory for it";
  }
  std::error_code ignored;
  common_.warn(why + (std::filesystem::exists(checkpoint(), ignored)
                          ? "; the checkpoint before it is kept"
                          : "; there is no checkpoint yet"));
  return false;
}

void Delivery::renew(const Plan& plan, Progress& progress) {
  const auto each = [&](double& due, double every, const auto& work) {
    if (due == 0) due = progress.began + every;
    if (progress.seconds < due) return;
    const auto before = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
    due = progress.seconds + std::max(every, 10 * took.count());
  };
  if (!checkpoint().empty())
    each(due_[0], a_.checkpoint_every < 0 ? kCheckpointEvery : a_.checkpoint_every,
         [&] { save(plan, progress); });
  if (!a_.preview.empty()) each(due_[1], kPreviewEvery, [&] { show(progress.film.picture()); });
}

// A failure is ignored: the final write will report it.
void Delivery::show(const Picture& picture) const {
  try {
    const std::optional<double> exposure = exposure_of(picture, a_.preview, a_.exposure);
    write_output(a_.preview, preview_bytes(picture, *exposure));
  } catch (const OutputError&) {
  }
}

std::string Delivery::deliver(const RenderResult& result, const Channels& channels,
                              nlohmann::ordered_json& stats) {
  if (result.target) facts_.attributes.merge(target_attributes(*result.target));
  if (result.progress->interrupted && facts_.attributes.contains(kFrameAttribute))
    facts_.attributes[kFrameAttribute] = kIncomplete;
  const bool saved = !checkpoint().empty() && !result.plan.cut_short &&
                     save(result.plan, *result.progress, channels);
  const Film& film = result.progress->film;
  const bool is_shard = !a_.shard.empty();
  ExrFile file{result.picture, {}, {}, {}, {}};
  std::optional<denoise::Filtered> filtered;
  const auto start = std::chrono::steady_clock::now();
  if (!is_shard) file = denoise::filtered_picture(film, facts_, channels, filtered);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  if (filtered && filtered->left)
    stats["filtered"] = {{"relmse", filtered->left->relmse},
                         {"interval", {filtered->left->low, filtered->left->high}}};
  const std::optional<double> exposure = exposure_of(file.picture, a_.preview, a_.exposure);
  if (exposure) stats["exposure"] = *exposure;
  warn_of_range(file, a_.storage(), common_);
  const auto bytes = [&] {
    return is_shard ? film_bytes(*result.progress, result.plan, facts_, channels)
                    : exr_bytes(file, a_.storage());
  };
  try {
    cli::deliver({{common_.output, bytes},
                  {a_.preview, [&] { return preview_bytes(file.picture, *exposure); }},
                  {a_.nonzero, [&] { return nonzero_png(result.picture); }},
                  {a_.stats, [&] { return stats.dump() + '\n'; }}},
                 common_);
  } catch (const OutputError& e) {
    throw Error(e.code, fmt::format("{}; {}", e.what(),
                                    saved ? fmt::format("all samples are in {}: --resume writes "
                                                        "the picture",
                                                        display_name(checkpoint()))
                                          : kept_sentence(common_.output, bytes())));
  }
  if (filtered) return fmt::format("{}; {:.1f} s", sentence_of(*filtered), took.count());
  return a_.filters() && !is_shard ? "not filtered: there is one sample per pixel" : "";
}

}  // namespace tdpt
