#include "tools/exrdiff/difference.h"

#include <algorithm>
#include <cmath>

#include "libcommon/formats/tone.h"
#include "tools/exrdiff/measure.h"

namespace tdpt {

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

}  // namespace tdpt
