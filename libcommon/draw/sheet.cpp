#include "libcommon/draw/sheet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt::draw {

void heading(Canvas& canvas, const std::string& title, const std::string& sentence) {
  const double room = canvas.width() - 2 * kMargin;
  canvas.text({kMargin, kMargin + 12}, title,
              {.size = kTitleSize, .ink = kInk, .bold = true, .room = room});
  canvas.text({kMargin, kMargin + 40}, sentence, {.size = kTextSize, .ink = kMuted, .room = room});
}

void caption(Canvas& canvas, const Box& panel, const std::string& words) {
  canvas.text({panel.x, panel.bottom() + 24}, words,
              {.size = kTextSize, .ink = kInk, .room = panel.width});
}

double scale_bar(Canvas& canvas, Point right, double pixels_per_metre) {
  double metres = std::pow(10, std::floor(std::log10(160 / pixels_per_metre)));
  for (const double step : {5.0, 2.0})
    if (metres * step * pixels_per_metre <= 160) {
      metres *= step;
      break;
    }
  const double left = right.x - metres * pixels_per_metre;
  canvas.line({left, right.y}, right, 2, kInk);
  for (const double x : {left, right.x}) canvas.line({x, right.y - 4}, {x, right.y + 4}, 2, kInk);
  canvas.text({0.5 * (left + right.x), right.y - 9}, number_words(metres, 6) + " m",
              {kSmallSize, kInk, Align::middle});
  return left;
}

void heat_bar(Canvas& canvas, const Box& bar, const std::string& title, const std::string& low,
              const std::string& high) {
  Raster scale(static_cast<int>(bar.width), static_cast<int>(bar.height));
  for (int y = 0; y < scale.height(); ++y)
    for (int x = 0; x < scale.width(); ++x) scale.at(x, y) = heat(x / bar.width);
  canvas.raster({bar.x, bar.y}, 1, scale);
  canvas.text({bar.x, bar.y - 10}, title, {kSmallSize, kInk});
  canvas.text({bar.x, bar.bottom() + 18}, low, {kSmallSize, kMuted});
  canvas.text({bar.right(), bar.bottom() + 18}, high, {kSmallSize, kMuted, Align::right});
}

void key(Canvas& canvas, Point start, const std::vector<std::pair<Ink, std::string>>& entries) {
  Point at = start;
  for (const auto& [c, words] : entries) {
    const double width = 24 + text_width(words, kTextSize);
    if (at.x > start.x && at.x + width > canvas.width() - kMargin) at = {start.x, at.y + kKeyRow};
    canvas.fill({at.x, at.y - 12, 16, 14}, c);
    canvas.text({at.x + 24, at.y}, words, {kTextSize, kInk});
    at.x += width + 30;
  }
}

void reach_square(Canvas& canvas, const Box& square, const std::string& light,
                  const std::string& camera) {
  Raster shades(static_cast<int>(square.width), static_cast<int>(square.height));
  for (int y = 0; y < shades.height(); ++y)
    for (int x = 0; x < shades.width(); ++x)
      shades.at(x, y) = reach(x / (square.width - 1), 1 - y / (square.height - 1));
  canvas.raster({square.x, square.y}, 1, shades);
  canvas.text({square.right() + 12, square.bottom() - 1}, light, {kSmallSize, kInk});
  canvas.text({square.right() + 12, square.y + kSmallSize}, camera, {kSmallSize, kInk});
}

std::string number(double value) {
  if (!(std::abs(value) >= 1000)) return number_words(value);
  const std::string digits = fmt::format("{:.0f}", std::abs(value));
  std::string grouped = value < 0 ? "-" : "";
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ' ';
    grouped += digits[i];
  }
  return grouped;
}

std::string base_name(const std::string& path) {
  return path == "-" ? "(standard input)" : path.substr(path.find_last_of('/') + 1);
}

std::array<uint8_t, 4> bytes_of(const Ink& c, uint8_t alpha) {
  const auto byte = [](float v) { return static_cast<uint8_t>(std::lround(255 * v)); };
  return {byte(c.x), byte(c.y), byte(c.z), alpha};
}

Ink heat(double amount) {
  static constexpr std::array<Ink, 8> kSteps{ink(0xf6eee0), ink(0xf8d9a0), ink(0xf5b761),
                                             ink(0xeb8c47), ink(0xd45c4c), ink(0xa93863),
                                             ink(0x702364), ink(0x32124a)};
  const double at = std::clamp(amount, 0.0, 1.0) * (kSteps.size() - 1);
  const auto k = std::min(static_cast<size_t>(at), kSteps.size() - 2);
  return mix(kSteps[k], kSteps[k + 1], at - static_cast<double>(k));
}

Ink reach(double light, double camera) {
  const double l = std::clamp(light, 0.0, 1.0), c = std::clamp(camera, 0.0, 1.0);
  return mix(mix(kClay, kLight, l), mix(kCamera, kBoth, l), c);
}

Ink region(int k, int n) {
  // Hues for regions between the two ends, distinct from both.
  static constexpr std::array<Ink, 7> kBetween{ink(0x9cc48a), ink(0xc69bbd), ink(0x7fc4c0),
                                               ink(0xdf9d90), ink(0xb9a26a), ink(0x9a94cf),
                                               ink(0xd9d36f)};
  if (k <= 0) return kLight;
  if (k >= n - 1) return kCamera;
  return kBetween[static_cast<size_t>(k - 1) % kBetween.size()];
}

}  // namespace tdpt::draw
