#include "tools/exrdiff/report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/process.h"
#include "libcommon/base/words.h"

namespace tdpt {

std::string report_text(const Comparison& c) {
  std::string text = fmt::format("{:<16}{:>12}{:>16}\n", "", "picture", "all black");
  const auto figure = [](double value) { return number_words(value, 5); };
  const auto row = [&](const char* name, double picture, double black) {
    text += fmt::format("{:<16}{:>12}{:>16}\n", name, figure(picture), figure(black));
  };
  row("relMSE", c.picture.relmse, c.black.relmse);
  row("  99.9 % best", c.picture.relmse_trimmed, c.black.relmse_trimmed);
  row("MAPE [%]", c.picture.mape, c.black.mape);
  row("PSNR [dB]", c.picture.psnr, c.black.psnr);
  row("MSE", c.picture.mse, c.black.mse);
  text += fmt::format("{:<16}{:>12}  (reference {})\n", "mean", figure(c.mean),
                      figure(c.reference_mean));
  text += fmt::format("{:<16}{:>12}\n", "non-zero share", figure(c.nonzero));
  return text;
}

std::string report_json(const Comparison& c) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  Json j;
  j["mape"] = c.picture.mape;
  j["psnr"] = number(c.picture.psnr);
  j["mse"] = c.picture.mse;
  j["relmse"] = c.picture.relmse;
  j["relmse_trimmed"] = c.picture.relmse_trimmed;
  j["mean"] = c.mean;
  j["reference_mean"] = c.reference_mean;
  j["nonzero"] = c.nonzero;
  j["peak"] = c.peak;
  j["black"] = {{"mape", c.black.mape}, {"psnr", number(c.black.psnr)}, {"relmse", c.black.relmse}};
  return j.dump();
}

cli::Decisions decisions_of(const Comparison& c, const Picture& reference, int64_t without_data,
                            const std::string& output) {
  const size_t pixels = reference.pixels.size();
  return {
      {"pixels without data", without_data > 0 ? "counted as black" : "none",
       fmt::format("{} of {} lie outside the data window", without_data, 2 * pixels), ""},
      {"relative measures", fmt::format("offset by {}", number_words(relative_offset(reference))),
       "dark components must not divide by zero: a hundredth of the reference's mean magnitude",
       ""},
      {"99.9 % best", fmt::format("{} of {} pixels forgiven", pixels / 1000, pixels),
       "few fireflies can hold most of relMSE",
       fmt::format("{} of relMSE {}", number_words(c.picture.relmse - c.picture.relmse_trimmed),
                   number_words(c.picture.relmse))},
      {"verdict", c.picture.relmse < c.black.relmse ? "better than black" : "no better than black",
       fmt::format("relMSE is {}, that of a black picture {}", number_words(c.picture.relmse),
                   number_words(c.black.relmse)),
       ""},
      {"difference picture",
       output.empty()                ? "left out"
       : suffix_of(output) == ".png" ? "made in false colour"
                                     : "made with sign",
       output.empty() ? "-o is not given" : "the name in -o says so",
       cli::price_of(cpu_seconds()) + " in all"}};
}

}  // namespace tdpt
