#include "tools/tdpt-render/path/light/panels.h"

#include <algorithm>

namespace tdpt {
namespace {

// Of H, as a share of half a panel's diagonal: c would fold a panel whose plane is grazed into its
// axes.
constexpr double kLeastHeight = 0.05;
constexpr double kFlat = 1e-6;    // canonical; corners are floats
constexpr double kSquare = 1e-3;  // of an edge: the density takes a panel for length_x length_y

using Corners = std::array<Vec3d, 3>;
Corners corners_of(const TriangleShape& s) {
  return {s.p0, s.p0 + s.e1, s.p0 + s.e2};
}

// Two triangles as a rectangle: which corners of either are which of the rectangle's.
struct CommonEdge {
  size_t i, j;  // the right angle that the rectangle begins with is b's, opposite their edge
};
std::optional<CommonEdge> common_edge(const Corners& a, const Corners& b) {
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      if (a[i] == b[(j + 1) % 3] && a[(i + 1) % 3] == b[j]) return CommonEdge{i, j};
  return std::nullopt;
}

double compressed(double v, double H) {
  return v / (H + std::abs(v));
}
// ds dt / (da db).
double spread(double s, double t, double H) {
  const double f = (H + std::abs(s)) * (H + std::abs(t)) / H;
  return f * f;
}

// Where a density that is linear on [0,1] has grown by `share`.
double linear(double w0, double w1, double share) {
  const double root = std::sqrt(w0 * w0 + share * (w1 * w1 - w0 * w0));
  return w0 + root > 0 ? std::min(1.0, share * (w0 + w1) / (w0 + root)) : share;
}
double bilinear(const std::array<double, 4>& R, double U, double V) {
  const double low = R[0] + U * (R[1] - R[0]), high = R[2] + U * (R[3] - R[2]);
  return low + V * (high - low);
}

std::optional<Panels::Panel> joined(const Scene& scene, const Lights& lights, uint32_t first,
                                    uint32_t second) {
  const TriangleShape sa = shape_of(scene, first), sb = shape_of(scene, second);
  const Corners a = corners_of(sa), b = corners_of(sb);
  const auto edge = common_edge(a, b);
  if (!edge) return std::nullopt;
  // Around: a_i, the corner of b beyond the edge, a_{i+1}, the corner of a beyond it.
  const auto [i, j] = *edge;
  const std::array<Vec3d, 4> around{a[i], b[(j + 2) % 3], a[(i + 1) % 3], a[(i + 2) % 3]};
  Panels::Panel panel;
  panel.corner = around[0];
  const Vec3d x = around[1] - around[0], y = around[3] - around[0];
  panel.length_x = length(x);
  panel.length_y = length(y);
  panel.x = x / panel.length_x;
  panel.y = y / panel.length_y;
  panel.normal = sa.normal;
  const double skew = std::abs(dot(panel.x, panel.y)) * std::min(panel.length_x, panel.length_y);
  const double most = std::min(kFlat, kSquare * std::min(panel.length_x, panel.length_y));
  if (!(skew < most) || !(length(around[0] + x + y - around[2]) < most)) return std::nullopt;
  const bool both = scene.material_of(first).double_sided;
  if (both != scene.material_of(second).double_sided) return std::nullopt;
  panel.both_sides = both;
  panel.least_height = kLeastHeight * 0.5 * length(around[2] - around[0]);
  panel.luminance = 0.5 * (lights.pdf_A(first) + lights.pdf_A(second)) / (both ? 2 : 1);
  panel.triangle = {second, first};
  const auto at = [](size_t k) { return k % 3; };
  panel.corners[0][at(j + 1)] = 0;
  panel.corners[0][at(j + 2)] = 1;
  panel.corners[0][at(j)] = 2;
  panel.corners[1][at(i)] = 0;
  panel.corners[1][at(i + 1)] = 2;
  panel.corners[1][at(i + 2)] = 3;
  return panel;
}

}  // namespace

Panels::Panels(const Scene& scene, const Lights& lights) {
  std::vector<uint32_t> rest;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (lights.pdf_A(t) > 0) {
      if (rest.size() == 2 * kMost) return;
      rest.push_back(t);
    }
  std::vector<Panel> found;
  while (!rest.empty()) {
    std::optional<Panel> panel;
    size_t other = 1;
    while (other < rest.size() && !(panel = joined(scene, lights, rest[0], rest[other]))) ++other;
    if (!panel) return;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(other));
    rest.erase(rest.begin());
    found.push_back(*panel);
  }
  if (found.size() == 1 && found[0].length_x * found[0].length_y < kBig) return;
  all_ = std::move(found);
}

void Panels::look(const Panel& panel, const Vertex& v, const Vec3d& up, View& view) {
  view.total = 0;
  const Vec3d r = panel.corner - v.position;
  const double height = -dot(panel.normal, r);
  if (!(height > 0) && !(panel.both_sides && height < 0)) return;
  const double z = dot(up, r);
  const double z_x = dot(up, panel.x) * panel.length_x, z_y = dot(up, panel.y) * panel.length_y;
  std::array<double, 4> over{z, z + z_x, z + z_y, z + z_x + z_y};
  const bool both_ways = v.outlook.facing == Vec3d();
  double highest = 0;
  for (double& o : over) {
    o = both_ways ? std::abs(o) : std::max(o, 0.0);
    highest = std::max(highest, o);
  }
  if (!(highest > 0)) return;
  const double h = std::abs(height), H = std::max(h, panel.least_height);
  view.H = H;
  view.s = dot(panel.x, r);
  view.t = dot(panel.y, r);
  const std::array<double, 2> s{view.s, view.s + panel.length_x},
      t{view.t, view.t + panel.length_y};
  const std::array<double, 2> f{H + std::abs(s[0]), H + std::abs(s[1])};
  const std::array<double, 2> g{H + std::abs(t[0]), H + std::abs(t[1])};
  const double scale = h / (H * H);
  double sum = 0;
  for (size_t k = 0; k < 4; ++k) {
    const size_t i = k & 1, j = k >> 1;
    const double spread_per_d2 = f[i] * g[j] / (s[i] * s[i] + t[j] * t[j] + h * h);
    view.R[k] = over[k] * scale * spread_per_d2 * spread_per_d2;
    sum += view.R[k];
  }
  view.a0 = s[0] / f[0];
  view.a1 = s[1] / f[1];
  view.b0 = t[0] / g[0];
  view.b1 = t[1] / g[1];
  view.total = 0.25 * sum * (view.a1 - view.a0) * (view.b1 - view.b0);
}

namespace {

// On the side of the shading normal that the edges of the path are on, if there is one.
Vec3d horizon(const Vertex& v) {
  const Vec3d& facing = v.outlook.facing;
  if (v.simple) return facing;
  return dot(v.shading, facing) < 0 ? -v.shading : v.shading;
}

}  // namespace

const Panels::Panel* Panels::find(uint32_t triangle) const {
  for (const Panel& panel : all_)
    if (panel.triangle[0] == triangle || panel.triangle[1] == triangle) return &panel;
  return nullptr;
}

double Panels::sent(const Vertex& v) const {
  const Vec3d up = horizon(v);
  double sum = 0;
  View view;
  for (const Panel& panel : all_) {
    look(panel, v, up, view);
    sum += panel.luminance * view.total;
  }
  return sum;
}

bool Panels::sample(const Vertex& v, double pick, double u, double w, double& sent,
                    Lights::Point& point) const {
  const Vec3d up = horizon(v);
  std::array<View, kMost> views;
  sent = 0;
  for (size_t i = 0; i < all_.size(); ++i) {
    look(all_[i], v, up, views[i]);
    sent += all_[i].luminance * views[i].total;
  }
  if (!(sent > 0)) return false;
  double left = pick * sent;
  size_t chosen = all_.size();
  for (size_t i = 0; i < all_.size(); ++i) {
    const double share = all_[i].luminance * views[i].total;
    if (!(share > 0)) continue;
    chosen = i;
    if (left < share) break;
    left -= share;
  }
  const Panel& panel = all_[chosen];
  const View& seen = views[chosen];
  const auto& R = seen.R;
  const double V = linear(R[0] + R[1], R[2] + R[3], w);
  const double U = linear(R[0] + V * (R[2] - R[0]), R[1] + V * (R[3] - R[1]), u);
  const auto stretched = [&](double c) { return seen.H * c / (1 - std::abs(c)); };
  const double s = stretched(seen.a0 + U * (seen.a1 - seen.a0));
  const double t = stretched(seen.b0 + V * (seen.b1 - seen.b0));
  const double x = std::clamp((s - seen.s) / panel.length_x, 0.0, 1.0);
  const double y = std::clamp((t - seen.t) / panel.length_y, 0.0, 1.0);
  point.position = panel.corner + panel.x * (x * panel.length_x) + panel.y * (y * panel.length_y);
  const size_t half = x >= y ? 0 : 1;
  const std::array<double, 4> weight{1 - std::max(x, y), x - y, std::min(x, y), y - x};
  point.triangle = panel.triangle[half];
  point.b1 = weight[panel.corners[half][1]];
  point.b2 = weight[panel.corners[half][2]];
  point.pdf = panel.luminance * bilinear(R, U, V) / (spread(s, t, seen.H) * sent);
  return point.pdf > 0;
}

double Panels::pdf_A(const Vertex& v, double sent, uint32_t triangle, const Vec3d& position) const {
  const Panel* const panel = find(triangle);
  if (!panel || !(sent > 0)) return 0;
  View seen;
  look(*panel, v, horizon(v), seen);
  if (!(seen.total > 0)) return 0;
  const Vec3d r = position - v.position;
  const double s = dot(panel->x, r), t = dot(panel->y, r);
  const double U = (compressed(s, seen.H) - seen.a0) / (seen.a1 - seen.a0);
  const double V = (compressed(t, seen.H) - seen.b0) / (seen.b1 - seen.b0);
  return panel->luminance * bilinear(seen.R, std::clamp(U, 0.0, 1.0), std::clamp(V, 0.0, 1.0)) /
         (spread(s, t, seen.H) * sent);
}

}  // namespace tdpt
