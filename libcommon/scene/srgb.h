// Linear value of a byte of an image.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace tdpt {

using LinearTable = std::array<float, 256>;

/// Linear light of an sRGB byte (IEC 61966-2-1).
inline const LinearTable& linear_of_srgb() {
  static const LinearTable table = [] {
    LinearTable t{};
    for (size_t i = 0; i < t.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table;
}

/// byte / 255.
inline const LinearTable& linear_of_byte() {
  static const LinearTable table = [] {
    LinearTable t{};
    for (size_t i = 0; i < t.size(); ++i) t[i] = static_cast<float>(i) / 255.0f;
    return t;
  }();
  return table;
}

}  // namespace tdpt
