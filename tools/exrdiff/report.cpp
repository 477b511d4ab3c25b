#include "tools/exrdiff/report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/number_words.h"

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

}  // namespace tdpt
