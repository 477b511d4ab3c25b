#include "libcommon/draw/drawing.h"

#include <algorithm>
#include <set>

#include "libcommon/base/words.h"

namespace tdpt::draw {
namespace {

constexpr double kTitleSize = 17, kTextSize = 10.5, kSmallSize = 9, kKeyRow = 26, kNoteRow = 20;
constexpr double kNear = 1e-3;     // near plane of the pinhole [m]
constexpr double kHidden = 0.3;    // factor of alpha behind a surface
constexpr double kTallest = 1040;  // of all panels together, where they can be smaller

bool overlap(const Rectangle& a, const Rectangle& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

class PanelDrawer {
 public:
  PanelDrawer(Canvas& canvas, const Panel& panel)
      : canvas_(canvas), panel_(panel), view_(panel.view) {}

  void draw_backdrop() {
    canvas_.clip(view_.panel);
    canvas_.raster({std::round(view_.panel.x), std::round(view_.panel.y)}, panel_.texel,
                   panel_.backdrop);
    canvas_.unclip();
  }

  void draw(const Shape& shape) {
    if (shape.through && !shows(shape)) return;
    canvas_.clip(view_.panel);
    const size_t corners = shape.corners();
    for (size_t i = 0; i + corners <= shape.positions.size(); i += corners) {
      const Vec3d* p = &shape.positions[i];
      const Paint& paint = shape.paints[i];
      if (corners == 1)
        draw_point(*p, shape, paint);
      else if (corners == 2)
        draw_line(p[0], p[1], shape, paint, shape.paints[i + 1]);
      else
        draw_triangle(p, shape, paint);
    }
    canvas_.unclip();
  }

  // Beside their places, where no other label is; each words once.
  void draw(const std::vector<Label>& labels) {
    constexpr double kHigh = kSmallSize + 7;
    std::set<std::string> written;
    for (const Label& label : labels) {
      const Pixel at = view_.project(label.place);
      if (!panel_.shows(label.place) || !view_.panel.contains(at)) continue;
      if (!written.insert(label.words).second) continue;
      const double wide = text_width(label.words, kSmallSize) + 8;
      Rectangle best;
      double least = INFINITY;
      for (const double away : {24.0, 38.0, 54.0, 74.0, 98.0})
        for (int k = 0; k < 16; ++k) {
          const double angle = 2 * 3.14159265358979 * (k + 0.5) / 16;
          const Rectangle r{at.x + std::cos(angle) * (away + 0.5 * wide) - 0.5 * wide,
                            at.y + std::sin(angle) * (away + 0.5 * kHigh) - 0.5 * kHigh, wide,
                            kHigh};
          if (r.x < view_.panel.x + 2 || r.right() > view_.panel.right() - 2 ||
              r.y < view_.panel.y + 2 || r.bottom() > view_.panel.bottom() - 2)
            continue;
          double cost = away;
          for (const Rectangle& other : taken_) cost += overlap(r, other) ? 1000 : 0;
          for (const Label& other : labels)
            cost += r.contains(view_.project(other.place)) ? 300 : 0;
          if (cost < least) least = cost, best = r;
        }
      if (!(least < INFINITY)) continue;
      taken_.push_back(best);
      canvas_.line(
          at, {std::clamp(at.x, best.x, best.right()), std::clamp(at.y, best.y, best.bottom())}, 1,
          label.ink);
      canvas_.fill(best, ink(0xffffff), 0.88);
      canvas_.text({best.x + 4, best.bottom() - 4}, label.words, {kSmallSize, label.ink});
    }
  }

  void finish() {
    const Rectangle& r = view_.panel;
    canvas_.frame(r, 1, kFaint);
    double room = r.width;
    if (!view_.pinhole) room = draw_axes(draw_scale_bar() - 64) - r.x - 12;
    canvas_.text({r.x, r.bottom() + 24}, panel_.caption,
                 {.size = kTextSize, .ink = kInk, .room = std::max(room, 1.0)});
  }

 private:
  // A mark is drawn as a whole where a fifth of its height is: one that only its sill lies below
  // the floor of belongs to the storey above.
  bool shows(const Shape& mark) const {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3d& p : mark.positions) low = std::min(low, p.y), high = std::max(high, p.y);
    const double shown = std::min(high, panel_.top) - std::max(low, panel_.bottom);
    return shown > 0 ? shown >= 0.2 * (high - low) : shown == 0 && low == high;
  }
  bool shows(const Shape& shape, const Vec3d& place) const {
    return shape.through || panel_.shows(place);
  }
  bool is_hidden(const Pixel& at, double depth) const {
    const int x = static_cast<int>((at.x - view_.panel.x) / panel_.texel),
              y = static_cast<int>((at.y - view_.panel.y) / panel_.texel);
    if (panel_.depth.empty() || x < 0 || x >= panel_.backdrop.width() || y < 0 ||
        y >= panel_.backdrop.height())
      return false;
    const double surface = static_cast<double>(
        panel_.depth[static_cast<size_t>(x) +
                     static_cast<size_t>(panel_.backdrop.width()) * static_cast<size_t>(y)]);
    return surface < depth - 0.01 * std::max(std::abs(depth), 0.2);
  }
  bool is_before(const Vec3d& place) const { return !view_.pinhole || view_.depth(place) >= kNear; }
  double alpha_of(const Paint& paint, const Vec3d& place, bool through) const {
    const auto alpha = static_cast<double>(paint.alpha);
    return !through && is_hidden(view_.project(place), view_.depth(place)) ? kHidden * alpha
                                                                           : alpha;
  }

  void draw_point(const Vec3d& place, const Shape& shape, const Paint& paint) {
    if (!shows(shape, place) || !is_before(place)) return;
    Pixel at = view_.project(place);
    // Thousands of small dots in the same place of their pixel take far fewer bytes.
    if (shape.size <= 1) at = {std::floor(at.x) + 0.5, std::floor(at.y) + 0.5};
    canvas_.disc(at, shape.size, paint.ink, alpha_of(paint, place, shape.through));
  }

  void draw_triangle(const Vec3d* p, const Shape& shape, const Paint& paint) {
    if (!shows(shape, (p[0] + p[1] + p[2]) / 3.0)) return;
    if (!is_before(p[0]) || !is_before(p[1]) || !is_before(p[2])) return;
    canvas_.polygon({view_.project(p[0]), view_.project(p[1]), view_.project(p[2])}, paint.ink,
                    static_cast<double>(paint.alpha));
  }

  void draw_line(Vec3d a, Vec3d b, const Shape& shape, const Paint& at_a, const Paint& at_b) {
    if (!(at_a == at_b)) {  // each half in its own colour
      draw_line(a, (a + b) * 0.5, shape, at_a, at_a);
      draw_line((a + b) * 0.5, b, shape, at_b, at_b);
      return;
    }
    // The part within the heights that the panel shows, and before the near plane.
    double enter = 0, leave = 1;
    const auto keep = [&](double va, double vb, double low) {  // where the value is at least `low`
      if (va < low && vb < low) leave = -1;
      const double t = (low - va) / (vb - va);
      if (va < low && vb >= low) enter = std::max(enter, t);
      if (va >= low && vb < low) leave = std::min(leave, t);
    };
    if (!shape.through) {
      keep(a.y, b.y, panel_.bottom);
      keep(-a.y, -b.y, -panel_.top);
    }
    if (view_.pinhole) keep(view_.depth(a), view_.depth(b), kNear);
    if (enter > leave) return;
    const Vec3d from = a + (b - a) * enter, to = a + (b - a) * leave;
    const Pixel pa = view_.project(from), pb = view_.project(to);
    const double pixels = std::hypot(pb.x - pa.x, pb.y - pa.y);
    if (!(pixels < 1e6)) return;
    const int steps = shape.through || panel_.depth.empty()
                          ? 1
                          : static_cast<int>(std::clamp(pixels / 2, 1.0, 4096.0));
    // A run of equal visibility is drawn as one line: round caps of single pieces would show as
    // beads.
    const auto place = [&](double t) { return from + (to - from) * t; };
    const auto alpha = [&](int k) {
      return alpha_of(at_a, place((k + 0.5) / steps), shape.through);
    };
    for (int first = 0, end; first < steps; first = end) {
      for (end = first + 1; end < steps && alpha(end) == alpha(first);) ++end;
      canvas_.line(view_.project(place(static_cast<double>(first) / steps)),
                   view_.project(place(static_cast<double>(end) / steps)), shape.size, at_a.ink,
                   alpha(first));
    }
  }

  // A bar of a round length below the right end of the panel; returns its left end.
  double draw_scale_bar() {
    const double scale = view_.pixels_per_metre(), right = view_.panel.right() - 2,
                 y = view_.panel.bottom() + 26;
    double metres = std::pow(10, std::floor(std::log10(160 / scale)));
    metres *= 5 * metres * scale <= 160 ? 5 : 2 * metres * scale <= 160 ? 2 : 1;
    const double left = right - metres * scale;
    canvas_.line({left, y}, {right, y}, 2, kInk);
    for (const double x : {left, right}) canvas_.line({x, y - 4}, {x, y + 4}, 2, kInk);
    canvas_.text({0.5 * (left + right), y - 9}, number_words(metres, 6) + " m",
                 {kSmallSize, kInk, Align::middle});
    return left;
  }

  // The axes of the scene that run along the panel's sides; returns the left end.
  double draw_axes(double left) {
    const Pixel corner{left, view_.panel.bottom() + (view_.up.y > 0.5 ? 30 : 14)};
    const auto arrow = [&](const Vec3d& axis, const Pixel& way) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs(axis[k]) < 0.999) continue;
        const double dx = way.x * axis[k], dy = way.y * axis[k];
        const Pixel tip{corner.x + dx, corner.y + dy};
        const double x = dx / std::hypot(dx, dy), y = dy / std::hypot(dx, dy);
        canvas_.line(corner, tip, 1.4, kMuted);
        canvas_.polygon({{tip.x + x * 5, tip.y + y * 5},
                         {tip.x - x * 2 - y * 3, tip.y - y * 2 + x * 3},
                         {tip.x - x * 2 + y * 3, tip.y - y * 2 - x * 3}},
                        kMuted);
        canvas_.text({tip.x + (y != 0 ? -12 : x * 14), tip.y + 4}, std::string(1, "xyz"[k]),
                     {kSmallSize, kMuted, Align::middle});
      }
    };
    arrow(view_.right, {20, 0});
    arrow(view_.up, {0, -13});
    return left - 24;
  }

  Canvas& canvas_;
  const Panel& panel_;
  const Projection& view_;
  std::vector<Rectangle> taken_;  // by labels
};

struct PlacedEntry {
  Pixel at;
  const KeyEntry* entry;
};
double swatch_width(const KeyEntry& entry) {
  const auto inks = static_cast<double>(entry.inks.size());
  return inks > 1 ? inks * std::ceil(90 / inks) : 16;  // whole pixels for each
}

// In rows from `y` on.
std::vector<PlacedEntry> placed(const std::vector<KeyEntry>& key, double y) {
  std::vector<PlacedEntry> entries;
  Pixel at{kMargin, y};
  for (const KeyEntry& entry : key) {
    const double width = swatch_width(entry) + 8 + text_width(entry.words, kTextSize);
    if (at.x > kMargin && at.x + width > kSheetWidth - kMargin) at = {kMargin, at.y + kKeyRow};
    entries.push_back({at, &entry});
    at.x += width + 30;
  }
  return entries;
}

void draw_entry(Canvas& canvas, const PlacedEntry& placed) {
  const std::vector<Ink>& inks = placed.entry->inks;
  const double width = swatch_width(*placed.entry), step = width / static_cast<double>(inks.size());
  for (size_t k = 0; k < inks.size(); ++k)
    canvas.fill({placed.at.x + step * static_cast<double>(k), placed.at.y - 12, step, 14}, inks[k]);
  canvas.text({placed.at.x + width + 8, placed.at.y}, placed.entry->words, {kTextSize, kInk});
}

}  // namespace

Projection Projection::of_camera(const Camera& camera, const Frame& frame, const Rectangle& panel) {
  const double half_height = std::tan(0.5 * camera.yfov);
  return {panel,          frame.to_metres(camera.position),         camera.right, camera.up,
          camera.forward, half_height * panel.width / panel.height, true};
}

Projection Projection::flat(const Vec3d& middle, const Vec3d& right, const Vec3d& up,
                            double half_right, double half_up, const Rectangle& panel) {
  const double half_width = std::max({half_right, half_up * panel.width / panel.height, 1e-6});
  return {panel, middle, right, up, cross(up, right), half_width, false};
}

Pixel Projection::project(const Vec3d& place) const {
  const Vec3d d = place - eye;
  const double scale = pixels_per_metre() / (pinhole ? dot(d, forward) : 1.0);
  return {panel.x + 0.5 * panel.width + scale * dot(d, right),
          panel.y + 0.5 * panel.height - scale * dot(d, up)};
}

void Projection::ray(const Pixel& at, Vec3d& from, Vec3d& w) const {
  const double u = (at.x - panel.x - 0.5 * panel.width) / pixels_per_metre(),
               v = (panel.y + 0.5 * panel.height - at.y) / pixels_per_metre();
  const Vec3d off = right * u + up * v;
  from = pinhole ? eye : eye + off;
  w = pinhole ? normalize(forward + off) : forward;
}

std::vector<Rectangle> arranged(const std::vector<double>& aspects) {
  std::vector<Rectangle> best;
  double most = 0;
  for (size_t columns = 1; columns <= aspects.size(); ++columns) {
    const size_t rows = (aspects.size() + columns - 1) / columns;
    double height = kTallest / static_cast<double>(rows) - kCaptionRoom;
    for (size_t row = 0; row < rows; ++row) {
      double sum = 0, room = kSheetWidth - kMargin;
      for (size_t k = row * columns; k < std::min((row + 1) * columns, aspects.size()); ++k)
        sum += aspects[k], room -= kMargin;
      height = std::min(height, room / sum);
    }
    height = std::floor(height);
    // Height times the share of the rows that panels fill, but for a factor that all have.
    const double worth = height * height / static_cast<double>(rows);
    if (worth <= most) continue;
    most = worth;
    best.clear();
    Pixel at{kMargin, kHeading};
    for (size_t k = 0; k < aspects.size(); ++k) {
      if (k > 0 && k % columns == 0) at = {kMargin, at.y + height + kCaptionRoom};
      best.push_back({at.x, at.y, std::floor(height * aspects[k]), height});
      at.x = best.back().right() + kMargin;
    }
  }
  return best;
}

Canvas draw(const Drawing& drawing) {
  double bottom = kHeading;
  for (const Panel& panel : drawing.panels)
    bottom = std::max(bottom, panel.view.panel.bottom() + kCaptionRoom);
  const std::vector<PlacedEntry> key = placed(drawing.key, bottom + 22);
  if (!key.empty()) bottom = key.back().at.y + 8;
  Canvas canvas(
      kSheetWidth,
      static_cast<int>(bottom + kNoteRow * static_cast<double>(drawing.notes.size()) + 24), kPaper);
  const double room = kSheetWidth - 2 * kMargin;
  canvas.text({kMargin, kMargin + 12}, drawing.title,
              {.size = kTitleSize, .ink = kInk, .bold = true, .room = room});
  canvas.text({kMargin, kMargin + 40}, drawing.sentence,
              {.size = kTextSize, .ink = kMuted, .room = room});
  for (const Panel& panel : drawing.panels) {
    PanelDrawer drawer(canvas, panel);
    drawer.draw_backdrop();
    for (const auto* shapes : {&panel.shapes, &drawing.shapes})
      for (const Shape& shape : *shapes) drawer.draw(shape);
    std::vector<Label> labels = drawing.labels;
    labels.insert(labels.end(), panel.labels.begin(), panel.labels.end());
    drawer.draw(labels);
    drawer.finish();
  }
  for (const PlacedEntry& entry : key) draw_entry(canvas, entry);
  for (const std::string& note : drawing.notes)
    canvas.text({kMargin, bottom += kNoteRow}, note,
                {.size = kSmallSize, .ink = kMuted, .room = room});
  return canvas;
}

}  // namespace tdpt::draw
