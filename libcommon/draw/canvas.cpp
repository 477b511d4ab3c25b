// Coverage of a pixel is taken from the distance of its centre to the edge of the shape, half a
// pixel either way.
#include "libcommon/draw/canvas.h"

#include <algorithm>
#include <cmath>

#include "libcommon/formats/png.h"

namespace tdpt::draw {

Canvas::Canvas(int width, int height, const Ink& paper)
    : width_(width),
      height_(height),
      pixels_(static_cast<size_t>(width) * static_cast<size_t>(height), paper) {
  unclip();
}

void Canvas::clip(const Box& box) {
  const auto limit = [](double v, int most) {
    return static_cast<int>(std::lround(std::clamp(v, 0.0, static_cast<double>(most))));
  };
  clip_left_ = limit(box.x, width_);
  clip_top_ = limit(box.y, height_);
  clip_right_ = limit(box.right(), width_);
  clip_bottom_ = limit(box.bottom(), height_);
}

void Canvas::blend(int x, int y, const Ink& c, double alpha) {
  if (x < clip_left_ || x >= clip_right_ || y < clip_top_ || y >= clip_bottom_) return;
  Ink& p = pixels_[index(x, y)];
  p = mix(p, c, std::clamp(alpha, 0.0, 1.0));
}

template <class Cover>
void Canvas::ink_where(double left, double top, double right, double bottom, const Ink& c,
                       double alpha, Cover&& cover) {
  if (!(left <= right && top <= bottom)) return;  // NaN, too
  const int x0 = static_cast<int>(std::clamp<double>(std::floor(left), clip_left_, clip_right_)),
            x1 = static_cast<int>(std::clamp<double>(std::ceil(right), clip_left_, clip_right_)),
            y0 = static_cast<int>(std::clamp<double>(std::floor(top), clip_top_, clip_bottom_)),
            y1 = static_cast<int>(std::clamp<double>(std::ceil(bottom), clip_top_, clip_bottom_));
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      if (const double share = cover(x + 0.5, y + 0.5); share > 0)
        blend(x, y, c, alpha * std::min(share, 1.0));
}

void Canvas::line(Point a, Point b, double line_width, const Ink& c, double alpha) {
  // A hair thinner than a pixel is a paler line of one pixel.
  const double half = 0.5 * std::max(line_width, 1.0);
  const double strength = alpha * std::min(line_width, 1.0);
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double reach = half + 1;
  const auto cover = [&](double x, double y) {
    const double t =
        squared > 0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / squared, 0.0, 1.0) : 0.0;
    return half + 0.5 - std::hypot(x - a.x - t * dx, y - a.y - t * dy);
  };
  // In pieces along the longer axis, so that a diagonal does not visit its whole bounding box.
  const double longest = std::max(std::abs(dx), std::abs(dy));
  if (!(longest < 1e6)) return;
  if (longest < 64) {
    ink_where(std::min(a.x, b.x) - reach, std::min(a.y, b.y) - reach, std::max(a.x, b.x) + reach,
              std::max(a.y, b.y) + reach, c, strength, cover);
    return;
  }
  const bool flat = std::abs(dx) >= std::abs(dy);
  const double from = flat ? std::min(a.x, b.x) - reach : std::min(a.y, b.y) - reach,
               to = flat ? std::max(a.x, b.x) + reach : std::max(a.y, b.y) + reach;
  const double slope = flat ? dy / dx : dx / dy, spread = reach * (1 + std::abs(slope)) + 1;
  const double first = std::max(std::floor(from), flat ? clip_left_ : clip_top_ + 0.0),
               last = std::min(std::ceil(to), flat ? clip_right_ : clip_bottom_ + 0.0);
  for (double k = first; k < last; ++k) {
    const double middle = flat ? a.y + (k + 0.5 - a.x) * slope : a.x + (k + 0.5 - a.y) * slope;
    if (flat)
      ink_where(k, middle - spread, k + 1, middle + spread, c, strength, cover);
    else
      ink_where(middle - spread, k, middle + spread, k + 1, c, strength, cover);
  }
}

void Canvas::disc(Point centre, double radius, const Ink& c, double alpha) {
  const double reach = radius + 1;
  ink_where(
      centre.x - reach, centre.y - reach, centre.x + reach, centre.y + reach, c, alpha,
      [&](double x, double y) { return radius + 0.5 - std::hypot(x - centre.x, y - centre.y); });
}

void Canvas::polygon(const std::vector<Point>& corners, const Ink& c, double alpha) {
  if (corners.size() < 3) return;
  double twice = 0, left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Point &p = corners[i], &q = corners[(i + 1) % corners.size()];
    twice += p.x * q.y - p.y * q.x;
    left = std::min(left, p.x), right = std::max(right, p.x);
    top = std::min(top, p.y), bottom = std::max(bottom, p.y);
  }
  const double turn = twice < 0 ? -1 : 1;
  ink_where(left - 1, top - 1, right + 1, bottom + 1, c, alpha, [&](double x, double y) {
    double inside = INFINITY;
    for (size_t i = 0; i < corners.size(); ++i) {
      const Point &p = corners[i], &q = corners[(i + 1) % corners.size()];
      const double ex = q.x - p.x, ey = q.y - p.y, edge = std::hypot(ex, ey);
      if (edge > 0) inside = std::min(inside, turn * (ex * (y - p.y) - ey * (x - p.x)) / edge);
    }
    return std::isfinite(inside) ? inside + 0.5 : 0.0;
  });
}

void Canvas::fill(const Box& box, const Ink& c, double alpha) {
  const auto overlap = [](double from, double to, double at) {
    return std::min(to, at + 0.5) - std::max(from, at - 0.5);
  };
  ink_where(box.x, box.y, box.right(), box.bottom(), c, alpha, [&](double x, double y) {
    return std::max(0.0, overlap(box.x, box.right(), x)) *
           std::max(0.0, overlap(box.y, box.bottom(), y));
  });
}

void Canvas::frame(const Box& box, double w, const Ink& c, double alpha) {
  fill({box.x, box.y, box.width, w}, c, alpha);
  fill({box.x, box.bottom() - w, box.width, w}, c, alpha);
  fill({box.x, box.y + w, w, box.height - 2 * w}, c, alpha);
  fill({box.right() - w, box.y + w, w, box.height - 2 * w}, c, alpha);
}

std::string Canvas::png() const {
  // 64 steps are as good as 256 to the eye where there are no slow gradients, and the soft edges of
  // a thousand lines take half the bytes.
  constexpr float kSteps = 63;
  std::vector<uint8_t> rgb;
  rgb.reserve(3 * pixels_.size());
  for (const Ink& p : pixels_)
    for (int c = 0; c < 3; ++c)
      rgb.push_back(static_cast<uint8_t>(
          std::lround(std::round(std::clamp(p[c], 0.0f, 1.0f) * kSteps) * (255 / kSteps))));
  return png_of_rgb8(width_, height_, rgb, PngKind::drawing);
}

}  // namespace tdpt::draw
