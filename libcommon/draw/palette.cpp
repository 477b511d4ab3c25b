#include "libcommon/draw/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt::draw {

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
