#include "tools/tdpt-render/testing/oracle_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/tdpt-render/testing/oracle_bsdf.h"

namespace tdpt::oracle {
namespace {

using std::numbers::pi;

/// Heights y of the centres of a map's rows, from pole to pole: 1, the centres', -1.
double node(const Sky::Map& map, int i) {
  return i == 0 ? 1 : i > map.height ? -1 : std::cos(pi * (i - 0.5) / map.height);
}

/// Position of a direction among the centres of texels: in columns from the first one, and in rows
/// of nodes.
struct Place {
  double column, row;
};
Place place_of(const Sky& sky, const Vec3d& towards) {
  const Sky::Map& map = sky.map();
  double x, y;
  sky.raster(towards, x, y);
  int row = static_cast<int>(y + 0.5);  // between centres in angle, and so in height
  const double up = node(map, row), low = node(map, row + 1);
  return {std::fmod(x - 0.5 + map.width, map.width),
          row + std::clamp((up - towards.y) / (up - low), 0.0, 1.0)};
}
Vec3d direction_of(const Sky& sky, const Place& p) {
  const Sky::Map& map = sky.map();
  const int row = std::min(static_cast<int>(p.row), map.height);
  const double t = p.row - row, y = (1 - t) * node(map, row) + t * node(map, row + 1);
  return sky.towards(p.column + 0.5, std::acos(y) / pi * map.height);
}

/// Of the map alone: linear in azimuth and in height.
double map_luminance(const Sky& sky, const Place& p) {
  const Sky::Map& map = sky.map();
  const auto texel = [&](int column, int row) {  // rows of nodes
    const int y = std::clamp(row - 1, 0, map.height - 1);
    return luminance(map.texels[static_cast<size_t>(y * map.width + column % map.width)]);
  };
  const int i = std::min(static_cast<int>(p.row), map.height), j = static_cast<int>(p.column);
  const double t = p.row - i, s = p.column - j;
  return (1 - t) * ((1 - s) * texel(j, i) + s * texel(j + 1, i)) +
         t * ((1 - s) * texel(j, i + 1) + s * texel(j + 1, i + 1));
}

bool lies_in(const Sky::Sun& sun, const Vec3d& towards) {
  return std::atan2(length(cross(towards, sun.towards)), dot(towards, sun.towards)) <=
         sun.half_angle;
}

double solid_angle(const Sky::Sun& sun) {
  return 4 * pi * std::pow(std::sin(sun.half_angle / 2), 2);
}

/// Coordinate of the resampled sky: t / (1 + |t|), t a tangent.
double compress(double t) {
  return t / (1 + std::abs(t));
}

/// Share of cell i of n over (-1, 1) between two tangents.
double overlap(int i, int n, double from, double to) {
  const double low = 2.0 * i / n - 1, high = 2.0 * (i + 1) / n - 1;
  return std::max(0.0, std::min(high, compress(to)) - std::max(low, compress(from))) * n / 2;
}

}  // namespace

/// The rectangle around a facet along its frame's axes, as seen from a point.
struct Rectangle {
  double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
  double height = 0;   ///< along z
  bool above = false;  ///< a corner of the surround is above the surface's horizon

  /// `front`: unit normal of the surface there, on the side that light arrives at; 0: both.
  Rectangle(const PortalSet& portals, const WindowSky::Window& window, const Vec3d& from,
            const Vec3d& front) {
    const WindowFrame& sky = *window.frame;
    for (uint32_t i = 0; i < portals.facets(); ++i) {
      const PortalSet::PortalFacet& facet = portals.load_portal_facet(i);
      if (length(facet.centre - window.centre) > 1e-9 || dot(facet.normal, sky.z) > 0) continue;
      height = dot(sky.z, facet.centre - from);
      for (const Vec3d& corner : portals.corners_of(facet)) {
        const double x = dot(sky.x, corner - from), y = dot(sky.y, corner - from);
        x0 = std::min(x0, x), x1 = std::max(x1, x);
        y0 = std::min(y0, y), y1 = std::max(y1, y);
      }
    }
    above = length(front) == 0;
    const Rectangle all = surround();
    for (const double x : {all.x0, all.x1})
      for (const double y : {all.y0, all.y1})
        above = above || dot(front, sky.x * x + sky.y * y + sky.z * height) > 0;
  }
  /// A tenth larger at all sides.
  Rectangle surround() const {
    Rectangle all = *this;
    const double x = 0.1 * (x1 - x0), y = 0.1 * (y1 - y0);
    all.x0 -= x, all.x1 += x, all.y0 -= y, all.y1 += y;
    return all;
  }
  bool seen() const { return height > 0 && above; }
  bool passed_along(const Vec3d& local) const {
    const double x = local.x / local.z * height, y = local.y / local.z * height;
    return x >= x0 && x <= x1 && y >= y0 && y <= y1;
  }
};

SkyLight::SkyLight(const Vista& vista) : vista_(vista) {
  const Sky& sky = *vista.world->scene.sky;
  const Sky::Map& map = sky.map();
  if (map.width > 0) {
    across_ = (127 + map.width) / map.width;
    down_ = (64 + map.height) / (map.height + 1);
  }
  for (int row = 0; row < (map.height + 1) * down_; ++row) {
    const double cell = 2 * pi / (map.width * across_) *
                        (node(map, row / down_) - node(map, row / down_ + 1)) / down_;
    for (int column = 0; column < map.width * across_; ++column) {
      const Place middle{(column + 0.5) / across_, (row + 0.5) / down_};
      const double light = map_luminance(sky, middle) * cell;  // linear, so the centre has the mean
      total_ += light;
      total_across_ += light * across_portals(direction_of(sky, middle));
    }
  }
  for (const Sky::Sun& sun : sky.suns()) {
    const double light = luminance(sun.radiance) * solid_angle(sun);
    total_ += light;
    total_across_ += light * across_portals(sun.towards);
  }
  for (const WindowSky::Window& window : vista.openings.windows.windows()) {
    const WindowFrame* const frame = window.frame.get();
    if (std::any_of(layouts_.begin(), layouts_.end(),
                    [&](const Layout& l) { return l.frame == frame; }))
      continue;
    Layout layout{frame, static_cast<int>(frame->cells), {}};
    const uint32_t* const sums = frame->sums.data();
    const uint32_t n = frame->cells + 1;
    for (uint32_t i = 0; i < frame->cells; ++i)
      for (uint32_t j = 0; j < frame->cells; ++j)
        layout.cells.push_back(frame->unit * (sums[(i + 1) * n + j + 1] - sums[i * n + j + 1] -
                                              sums[(i + 1) * n + j] + sums[i * n + j]));
    layouts_.push_back(layout);
  }
}

double SkyLight::across_portals(const Vec3d& towards) const {
  double area = 0;
  for (size_t i = 0; i < vista_.openings.portals.size(); ++i) {
    const PortalSet::Polygon& q = vista_.openings.portals.polygon(static_cast<int>(i));
    if (!q.surround) area += q.area * std::max(0.0, -dot(q.normal, towards));
  }
  return area;
}

double SkyLight::start_pdf_w(const Vec3d& towards) const {
  const Sky& sky = *vista_.world->scene.sky;
  const double plain = luminance(sky.radiance(towards)) / total_;
  if (!(total_across_ > 0)) return plain;
  double light = 0;
  if (across_ > 0) {
    const Place p = place_of(sky, towards);
    const Place middle{(std::floor(p.column * across_) + 0.5) / across_,
                       (std::floor(p.row * down_) + 0.5) / down_};
    light = map_luminance(sky, p) * across_portals(direction_of(sky, middle));
  }
  for (const Sky::Sun& sun : sky.suns())
    if (lies_in(sun, towards)) light += luminance(sun.radiance) * across_portals(sun.towards);
  return 0.1 * plain + 0.9 * light / total_across_;
}

const SkyLight::Layout& SkyLight::layout_of(const WindowSky::Window& window) const {
  return *std::find_if(layouts_.begin(), layouts_.end(),
                       [&](const Layout& l) { return l.frame == window.frame.get(); });
}

double SkyLight::seen_through(const WindowSky::Window& window, const Rectangle& r) const {
  if (!r.seen()) return 0;
  const Layout& layout = layout_of(window);
  const auto overlaps = [&](double low, double high) {
    std::vector<double> of_cells;
    for (int i = 0; i < layout.n; ++i)
      of_cells.push_back(overlap(i, layout.n, low / r.height, high / r.height));
    return of_cells;
  };
  const std::vector<double> along = overlaps(r.x0, r.x1), up = overlaps(r.y0, r.y1);
  double sum = 0;
  for (size_t i = 0; i < along.size(); ++i)
    for (size_t j = 0; j < up.size() && along[i] > 0; ++j)
      sum += along[i] * up[j] * layout.cells[i * up.size() + j];
  return sum;
}

double SkyLight::next_event_pdf_w(const Vertex& shaded, const Vertex& next, const Vec3d& towards,
                                  double q, double through) const {
  const double plain = luminance(vista_.world->scene.sky->radiance(towards)) / total_;
  const bool one_sided = shaded.simple || !bsdf::transmits(shaded.bsdf);
  const double side = dot(shaded.normal, next.position - shaded.position) < 0 ? -1 : 1;
  const double e = shader::kSurroundShare;
  double seen = 0, light = 0;
  for (size_t i = 0; i < vista_.openings.windows.windows().size(); ++i) {
    if (!(vista_.openings.windows.windows_in_view(shaded.position) >> i & 1u)) continue;
    const WindowSky::Window& window = vista_.openings.windows.windows()[i];
    const Rectangle r(vista_.openings.portals, window, shaded.position,
                      one_sided ? shaded.normal * side : Vec3d());
    seen += (1 - e) * seen_through(window, r) + e * seen_through(window, r.surround());
    const WindowFrame& frame = *window.frame;
    const Vec3d w(dot(frame.x, towards), dot(frame.y, towards), dot(frame.z, towards));
    if (!(r.seen() && w.z > 0 && r.surround().passed_along(w))) continue;
    // Content over solid angle: content per area of the plane z = 1, and area per solid angle.
    const Layout& layout = layout_of(window);
    const double s = w.x / w.z, t = w.y / w.z, n = layout.n;
    const auto cell = [&](double x) { return static_cast<size_t>((compress(x) + 1) / 2 * n); };
    const double area = std::pow((1 + std::abs(s)) * (1 + std::abs(t)) * 2 / n, 2);
    light += (r.passed_along(w) ? 1 : e) * layout.cells[cell(s) * frame.cells + cell(t)] /
             (area * std::pow(w.z, 3));
  }
  if (!(seen > 0)) return plain;
  return (1 - q) * plain + q * through * light / seen;
}

namespace {

Vec3d towards(const Vertex& from, const Vertex& to) {
  return to.at_infinity() ? -to.position : normalize(to.position - from.position);
}

// cos cos / d^2 of a point on a rectangular light.
double arrives(const Vertex& x1, const Vec3d& up, bool both_ways, const RectLight& rect_light,
               const Vec3d& place) {
  const Vec3d d = place - x1.position;
  const double cos = dot(up, normalize(d));
  return (both_ways ? std::abs(cos) : std::max(0.0, cos)) *
         std::abs(dot(rect_light.normal, normalize(d))) / dot(d, d);
}

// The plane of a rectangular light as seen from a point: s and t of a place on it, and a, b.
struct Layout {
  Layout(const RectLight& rect_light, const Vec3d& point)
      : x(rect_light.x),
        y(rect_light.y),
        foot(point - rect_light.normal * dot(rect_light.normal, point - rect_light.corner)) {
    const double diagonal = std::hypot(rect_light.length_x, rect_light.length_y);
    H = std::max(length(point - foot), 0.025 * diagonal);
  }
  double s(const Vec3d& place) const { return dot(x, place - foot) / H; }
  double t(const Vec3d& place) const { return dot(y, place - foot) / H; }
  static double c(double v) { return v / (1 + std::abs(v)); }
  double da_db_per_area(const Vec3d& place) const {
    return 1 / std::pow(H * (1 + std::abs(s(place))) * (1 + std::abs(t(place))), 2);
  }
  Vec3d x, y, foot;
  double H;
};

}  // namespace

double rect_light_pdf_A(const Vista& vista, const Vertex& x0, const Vertex& x1, const Vertex& x2) {
  const bool both_ways = !x1.simple && bsdf::transmits(x1.bsdf);
  const Vec3d way = towards(x1, x2);
  Vec3d up = x1.simple ? x1.normal : x1.shading;
  const Vec3d seen_from = dot(x1.normal, way) > 0 ? x1.normal : -x1.normal;
  if (!both_ways && dot(up, seen_from) < 0) up = -up;
  double sum = 0, mine = 0;
  for (const RectLight& rect_light : vista.world->rect_lights) {
    const double height = dot(rect_light.normal, x1.position - rect_light.corner);
    if (height == 0 || (height < 0 && !rect_light.source->both_sides())) continue;
    const Layout layout(rect_light, x1.position);
    const Vec3d u = rect_light.x * rect_light.length_x, v = rect_light.y * rect_light.length_y;
    // [i][j]: i along x, j along y.
    double R[2][2];
    double mean = 0;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const Vec3d corner = rect_light.corner + u * i + v * j;
        R[i][j] = arrives(x1, up, both_ways, rect_light, corner) / layout.da_db_per_area(corner);
        mean += R[i][j] / 4;
      }
    const double a0 = layout.c(layout.s(rect_light.corner)),
                 a1 = layout.c(layout.s(rect_light.corner + u));
    const double b0 = layout.c(layout.t(rect_light.corner)),
                 b1 = layout.c(layout.t(rect_light.corner + v));
    sum += rect_light.weight * mean * (a1 - a0) * (b1 - b0);
    if (rect_light.triangle0 != x0.triangle && rect_light.triangle1 != x0.triangle) continue;
    const double A = (layout.c(layout.s(x0.position)) - a0) / (a1 - a0);
    const double B = (layout.c(layout.t(x0.position)) - b0) / (b1 - b0);
    mine = rect_light.weight * layout.da_db_per_area(x0.position) *
           ((1 - A) * (1 - B) * R[0][0] + A * (1 - B) * R[1][0] + (1 - A) * B * R[0][1] +
            A * B * R[1][1]);
  }
  return sum > 0 ? mine / sum : 0;
}

}  // namespace tdpt::oracle
