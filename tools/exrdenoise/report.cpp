#include "tools/exrdenoise/report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/process.h"
#include "libcommon/base/words.h"

namespace tdpt {

std::string summary_json(const Picture& picture, const denoise::Filtered& filtered, double seconds,
                         std::optional<double> exposure) {
  Vec3d sum;
  for (const Rgb& p : picture.pixels) sum += Vec3d(p);
  const Vec3d mean = sum / static_cast<double>(picture.pixels.size());
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

cli::Decisions decisions_of(const denoise::Filtered& filtered) {
  const cli::Decision features{"features", filtered.has_features ? "used" : "none",
                               filtered.has_features
                                   ? "the picture has albedo, normal or depth"
                                   : "the picture has no albedo, normal and depth",
                               cli::price_of(cpu_seconds()) + " in all"};
  if (filtered.denoiser.starts_with(denoise::kKinds.back()))
    return {{"filter", filtered.denoiser, "--denoiser asks for it", ""}, features};
  return {{"filter", filtered.denoiser,
           filtered.denoiser == denoise::kKinds[1]
               ? "Open Image Denoise is not asked for, or not installed, or other frames help"
               : "Open Image Denoise is installed",
           ""},
          {"halves", fmt::format("{} of the samples in halfA", number_words(filtered.share_a, 2)),
           "the picture is that mean of the two", ""},
          {"outliers", counted(filtered.outliers, "pixel") + " darkened",
           "they were more than twice as bright as all around them, in one half alone",
           fmt::format("{} % of the light is left out", number_words(100 * filtered.left_out, 2))},
          features};
}

}  // namespace tdpt
