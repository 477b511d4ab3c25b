#include "libcommon/draw/sheet.h"

#include <cmath>

#include <fmt/format.h>

namespace tdpt::draw {

void heading(Canvas& canvas, const std::string& title, const std::string& sentence) {
  const double room = canvas.width() - 2 * kMargin;
  text(canvas, {kMargin, kMargin + 12}, fitted(title, kTitleSize, room), kTitleSize, kInk,
       Align::left, 1.15);
  text(canvas, {kMargin, kMargin + 40}, fitted(sentence, kTextSize, room), kTextSize, kMuted);
}

void caption(Canvas& canvas, const Box& panel, const std::string& words) {
  text(canvas, {panel.x, panel.bottom() + 24}, fitted(words, kTextSize, panel.width), kTextSize,
       kInk);
}

void scale_bar(Canvas& canvas, Point right, double pixels_per_metre) {
  double metres = std::pow(10, std::floor(std::log10(160 / pixels_per_metre)));
  for (const double step : {5.0, 2.0})
    if (metres * step * pixels_per_metre <= 160) {
      metres *= step;
      break;
    }
  const double left = right.x - metres * pixels_per_metre;
  canvas.line({left, right.y}, right, 2, kInk);
  for (const double x : {left, right.x}) canvas.line({x, right.y - 4}, {x, right.y + 4}, 2, kInk);
  text(canvas, {0.5 * (left + right.x), right.y - 9}, fmt::format("{:.6g} m", metres), kSmallSize,
       kInk, Align::middle);
}

void heat_bar(Canvas& canvas, const Box& bar, const std::string& title, const std::string& low,
              const std::string& high) {
  for (double x = 0; x < bar.width; ++x)
    canvas.fill({bar.x + x, bar.y, std::min(1.0, bar.width - x), bar.height}, heat(x / bar.width));
  text(canvas, {bar.x, bar.y - 10}, title, kSmallSize, kInk);
  text(canvas, {bar.x, bar.bottom() + 18}, low, kSmallSize, kMuted);
  text(canvas, {bar.right(), bar.bottom() + 18}, high, kSmallSize, kMuted, Align::right);
}

void key(Canvas& canvas, Point start, const std::vector<std::pair<Ink, std::string>>& entries) {
  Point at = start;
  for (const auto& [c, words] : entries) {
    const double width = 24 + text_width(words, kTextSize);
    if (at.x > start.x && at.x + width > canvas.width() - kMargin) at = {start.x, at.y + kKeyRow};
    canvas.fill({at.x, at.y - 12, 16, 14}, c);
    text(canvas, {at.x + 24, at.y}, words, kTextSize, kInk);
    at.x += width + 30;
  }
}

void reach_square(Canvas& canvas, const Box& square, const std::string& light,
                  const std::string& camera) {
  for (double y = 0; y < square.height; ++y)
    for (double x = 0; x < square.width; ++x)
      canvas.fill({square.x + x, square.y + y, 1, 1},
                  reach(x / (square.width - 1), 1 - y / (square.height - 1)));
  text(canvas, {square.right() + 12, square.bottom() - 1}, light, kSmallSize, kInk);
  text(canvas, {square.right() + 12, square.y + kSmallSize}, camera, kSmallSize, kInk);
}

std::string number(double value) {
  if (!(std::abs(value) >= 1000)) return fmt::format("{:.3g}", value);
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

std::string fitted(const std::string& words, double size, double width) {
  if (text_width(words, size) <= width) return words;
  std::string cut = words;
  while (!cut.empty() && text_width(cut + "...", size) > width) cut.pop_back();
  return cut + "...";
}

}  // namespace tdpt::draw
