#include "libcommon/formats/tone.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
namespace {

constexpr double kFade = 0.15, kGrey = 0.18;
constexpr double kFarAbove = 8;       // times the median: three stops
constexpr double kBrightest = 1e100;  // infinity is shown as this

double rolled_off(double p) {  // [eq. 1]
  return p <= 0.5 ? p : 1 - 0.25 / p;
}

}  // namespace

Vec3d toned(const Vec3d& exposed) {
  if (std::isnan(exposed.x) || std::isnan(exposed.y) || std::isnan(exposed.z)) return {};
  const Vec3d c = max(min(exposed, Vec3d(kBrightest)), Vec3d(-kBrightest));
  const double p = max_component(c);
  if (p <= 0.5) return c;
  const double f = rolled_off(p), w = 1 - 1 / (1 + kFade * (p - f));
  return (1 - w) * (f / p) * c + Vec3d(w * f);
}

Picture toned(const Picture& picture, double exposure) {
  const double scale = std::exp2(exposure);
  Picture shown = picture;
  for (size_t i = 0; i < shown.pixels.size(); ++i) {
    const double alpha = shown.alpha.empty() ? 1 : static_cast<double>(shown.alpha[i]);
    Rgb& pixel = shown.pixels[i];
    if (alpha > 0) pixel = Rgb(alpha * toned(scale / alpha * Vec3d(pixel)));
  }
  return shown;
}

std::string preview_bytes(const Picture& picture, double exposure) {
  return png_bytes(toned(picture, exposure));
}

double auto_exposure(const Picture& picture) {
  std::vector<double> lit;
  for (const Rgb& pixel : picture.pixels)
    if (const auto l = static_cast<double>(luminance(pixel)); std::isfinite(l) && l > 0)
      lit.push_back(l);
  if (lit.empty()) return 0;
  const auto median = lit.begin() + static_cast<std::ptrdiff_t>((lit.size() - 1) / 2);
  std::nth_element(lit.begin(), median, lit.end());
  std::erase_if(lit, [most = kFarAbove * *median](double l) { return l > most; });
  const auto too_dark = [&](int hundredths) {
    const double scale = std::exp2(0.01 * hundredths);
    double sum = 0;
    for (const double l : lit) sum += rolled_off(scale * l);
    return sum < kGrey * static_cast<double>(lit.size());
  };
  constexpr auto most = static_cast<int>(100 * kMostStops);
  int dark = -most, bright = most;
  while (bright - dark > 1) {
    const int middle = (dark + bright) / 2;
    (too_dark(middle) ? dark : bright) = middle;
  }
  return bright / 100.0;
}

}  // namespace tdpt
