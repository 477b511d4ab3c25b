#include "tools/exrdiff/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/tone.h"

namespace tdpt {
namespace {

double component(const Rgb& c, int i) {
  return static_cast<double>(c[i]);
}

// Of all components, or of their magnitudes.
double mean_of(const Picture& p, bool of_magnitudes = false) {
  double sum = 0;
  for (const Rgb& c : p.pixels)
    for (int i = 0; i < 3; ++i) sum += of_magnitudes ? std::abs(component(c, i)) : component(c, i);
  return sum / (3 * static_cast<double>(p.pixels.size()));
}

void expect_finite(const Picture& p, const std::string& name) {
  size_t count = 0, first = 0;
  for (size_t i = 0; i < p.pixels.size(); ++i)
    if (!is_finite(p.pixels[i]) && count++ == 0) first = i;
  if (count == 0) return;
  const auto width = static_cast<size_t>(p.width);
  const Rgb& c = p.pixels[first];
  std::string text = fmt::format("is {} {} {}, expected finite numbers", c.x, c.y, c.z);
  if (count > 1) text += fmt::format("; {} pixels are not finite", count);
  throw InputError(name, fmt::format("pixel {} {}", first % width, first / width), text);
}

// `picture` null: a black one.
Measures measure(const Picture* picture, const Picture& reference, double m, double peak) {
  const size_t n = reference.pixels.size();
  const double components = 3 * static_cast<double>(n);
  double squares = 0, relative = 0;
  std::vector<double> pixel_relative_squares(n);
  for (size_t k = 0; k < n; ++k)
    for (int i = 0; i < 3; ++i) {
      const double r = component(reference.pixels[k], i);
      const double d = (picture ? component(picture->pixels[k], i) : 0) - r;
      squares += d * d;
      relative += std::abs(d) / (std::abs(r) + 0.01 * m);
      pixel_relative_squares[k] += d * d / (r * r + 0.01 * m * m);
    }
  const auto sum = [](const std::vector<double>& v, size_t first_n) {
    double s = 0;
    for (size_t k = 0; k < first_n; ++k) s += v[k];
    return s;
  };
  Measures result;
  result.mse = squares / components;
  result.psnr = result.mse > 0 ? 10 * std::log10(peak * peak / result.mse)
                               : std::numeric_limits<double>::infinity();
  result.mape = 100 * relative / components;
  result.relmse = sum(pixel_relative_squares, n) / components;
  const size_t kept = n - n / 1000;
  std::sort(pixel_relative_squares.begin(), pixel_relative_squares.end());
  result.relmse_trimmed = sum(pixel_relative_squares, kept) / (3 * static_cast<double>(kept));
  return result;
}

}  // namespace

double relative_offset(const Picture& reference) {
  return 0.01 * mean_of(reference, true);
}

Comparison compare(const Picture& picture, const std::string& picture_name,
                   const Picture& reference, const std::string& reference_name) {
  if (picture.width != reference.width || picture.height != reference.height)
    throw InputError(
        picture_name, "",
        fmt::format("is {} x {} pixels, expected {} x {} like {}", picture.width, picture.height,
                    reference.width, reference.height, reference_name));
  expect_finite(picture, picture_name);
  expect_finite(reference, reference_name);
  const double m = mean_of(reference, true);
  if (m == 0)
    throw InputError(reference_name, "",
                     "is black everywhere, expected some light to compare with");

  Comparison c;
  for (const Rgb& p : reference.pixels)
    for (int i = 0; i < 3; ++i) c.peak = std::max(c.peak, std::abs(component(p, i)));
  c.picture = measure(&picture, reference, m, c.peak);
  c.black = measure(nullptr, reference, m, c.peak);
  c.mean = mean_of(picture);
  c.reference_mean = mean_of(reference);
  const auto lit = std::count_if(picture.pixels.begin(), picture.pixels.end(),
                                 [](const Rgb& p) { return p != Rgb(0); });
  c.nonzero = static_cast<double>(lit) / static_cast<double>(picture.pixels.size());
  return c;
}

Picture difference(const Picture& picture, const Picture& reference) {
  Picture result{picture.width, picture.height, picture.pixels};
  for (size_t k = 0; k < result.pixels.size(); ++k)
    result.pixels[k] = picture.pixels[k] - reference.pixels[k];
  return result;
}

Picture false_colour(const Picture& picture, const Picture& reference) {
  const auto offset = static_cast<float>(relative_offset(reference));
  Picture result{picture.width, picture.height, picture.pixels};
  for (size_t k = 0; k < result.pixels.size(); ++k) {
    const float expected = luminance(reference.pixels[k]);
    const float error = (luminance(picture.pixels[k]) - expected) / (std::abs(expected) + offset);
    const float rest = 1 - std::min(std::abs(error), 1.0f);
    result.pixels[k] = error > 0 ? Rgb(1, rest, rest) : Rgb(rest, rest, 1);
  }
  return result;
}

Picture side_by_side(const Picture& picture, const Picture& reference, double exposure) {
  const Picture left = toned(picture, exposure), right = toned(reference, exposure);
  constexpr int line = 2;
  Picture result{picture.width + line + reference.width, reference.height, {}};
  const auto width = static_cast<size_t>(picture.width);
  for (size_t y = 0; y < static_cast<size_t>(reference.height); ++y) {
    for (size_t x = 0; x < width; ++x) result.pixels.push_back(left.pixels[y * width + x]);
    result.pixels.insert(result.pixels.end(), line, Rgb(1));
    for (size_t x = 0; x < width; ++x) result.pixels.push_back(right.pixels[y * width + x]);
  }
  return result;
}

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

std::string report_json(const Comparison& c, std::optional<double> exposure) {
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
  if (exposure) j["exposure"] = *exposure;
  return j.dump();
}

cli::Decisions decisions_of(const Comparison& c, const Picture& reference) {
  return {
      {"relative measures", fmt::format("offset by {}", number_words(relative_offset(reference))),
       "dark components must not divide by zero: a hundredth of the reference's mean magnitude",
       ""},
      {"verdict", c.picture.relmse < c.black.relmse ? "better than black" : "no better than black",
       fmt::format("relMSE is {}, that of a black picture {}", number_words(c.picture.relmse),
                   number_words(c.black.relmse)),
       ""}};
}

}  // namespace tdpt
