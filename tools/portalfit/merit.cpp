// Figures of merit of portals, from the lines of the grid alone.
//
// Tightness without a scene: the grid's lines are a sample, uniform by etendue, of all lines that
// join the two sides. In the middle of an opening and close to its normal every line passes, so
// there the sample's density d [lines / (m2 sr)] is that of all lines, and
//   t = n / (d pi A).
// How close to the normal depends on the wall's thickness: the densest of several cones counts.
//
// n  lines of the portal's cut that cross the portal, of area A [m2]
// d  of the lines within an angle asin(s) of the normal that cross the portal's middle, half as
//    wide and half as high: their number over the etendue pi s^2 A/4
#include "tools/portalfit/merit.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "libcommon/scene/scene.h"

namespace tdpt {
namespace {

constexpr double kBorder = 0.01;  // of a voxel: rounding of a line's end

std::vector<LineCrossing> crossings_of(const std::vector<LightLine>& lines,
                                       const PortalShape& shape) {
  std::vector<LineCrossing> found;
  for (uint32_t l = 0; l < lines.size(); ++l)
    if (const auto at = crossing(shape.plane, lines[l]); at && contains(shape, *at))
      found.push_back({l, *at});
  return found;
}

// The cut that has the largest share of its lines cross the portal (a share, since cuts may differ
// in their number of lines).
size_t cut_of(const std::vector<LightLine>& lines, const std::vector<size_t>& of_cut,
              const std::vector<LineCrossing>& crossings) {
  std::vector<size_t> crossed(of_cut.size(), 0);
  for (const LineCrossing& c : crossings) ++crossed[lines[c.line].cut];
  const auto share = [&](size_t k) {
    return of_cut[k] ? static_cast<double>(crossed[k]) / static_cast<double>(of_cut[k]) : 0.0;
  };
  size_t most = 0;
  for (size_t k = 1; k < of_cut.size(); ++k)
    if (share(k) > share(most)) most = k;
  return most;
}

// Whether the line begins at the grid's border, as the lines do that come from the sky: a grid
// under a sky spans the rooms and the air around them.
bool begins_at_border(const LightGrid& grid, const LightLine& line) {
  const double rounding = kBorder * grid.voxel;
  for (int c = 0; c < 3; ++c) {
    const double at = line.light[c] - grid.origin[c];
    if (at < rounding || at > grid.voxel * grid.dim[static_cast<size_t>(c)] - rounding) return true;
  }
  return false;
}

// Whether it says what comes from the sky. Tables without walls have the box of the lines alone.
bool tells_of_sky(const LightGrid& grid) {
  return !grid.scene_hash.empty() &&
         std::find(grid.air.begin(), grid.air.end(), 0) != grid.air.end();
}

// Where the line crosses the shape, of its length from the light.
std::optional<double> way_to(const PortalShape& shape, const LightLine& line) {
  const auto at = crossing(shape.plane, line);
  if (!at || !contains(shape, *at)) return {};
  const double before = dot(shape.plane.o - line.light, shape.plane.n);
  return before / dot(line.camera - line.light, shape.plane.n);
}

}  // namespace

std::optional<double> tightness_of(const std::vector<LightLine>& lines, const PortalShape& shape,
                                   const std::vector<LineCrossing>& crossings) {
  if (crossings.empty()) return {};
  const auto in_the_middle = [&](const LineCrossing& c) { return contains(shape, c.at * 2); };
  const auto squared_sine = [&](const LineCrossing& c) {
    const LightLine& line = lines[c.line];
    const double cosine = dot(normalize(line.camera - line.light), shape.plane.n);
    return 1 - cosine * cosine;
  };
  const auto n = static_cast<double>(crossings.size());
  double densest = n / std::numbers::pi / shape.area;
  for (double sine2 = 1; sine2 > 1e-4; sine2 *= 0.25) {
    const auto inside = static_cast<double>(std::count_if(
        crossings.begin(), crossings.end(),
        [&](const LineCrossing& c) { return in_the_middle(c) && squared_sine(c) <= sine2; }));
    if (inside < 2.0 * kFewestLines) break;
    densest = std::max(densest, inside / (std::numbers::pi * sine2 * 0.25 * shape.area));
  }
  return std::min(1.0, n / (densest * std::numbers::pi * shape.area));
}

namespace {

// A portal with its cut, and that cut's lines that cross it.
struct Appraised {
  Portal* portal;
  PortalShape shape;
  size_t cut;
  std::vector<LineCrossing> crossings;
  std::optional<double> tightness;
};

// Sets the conductance of cut `c` on its portals. `lines`: of the cut. Lines that end on a jamb
// before they cross count for flux_share, but not for conductance: tightness / conductance is then
// the room's surface over the opening, wherever the cut runs.
void appraise_cut(const LightGrid& grid, size_t c, size_t lines,
                  const std::vector<Appraised>& portals) {
  std::vector<uint8_t> met(grid.lines.size(), 0);
  double passing = 0;
  const auto counts = [&](const Appraised& a) { return a.cut == c && a.tightness; };
  for (const Appraised& a : portals) {
    if (!counts(a)) continue;
    for (const LineCrossing& line : a.crossings)
      if (!met[line.line]) met[line.line] = 1, ++passing;
  }
  if (!(passing > 0)) return;
  const double conductance =
      grid.cuts[c].conductance * grid.cuts[c].kept * passing / static_cast<double>(lines);
  for (const Appraised& a : portals)
    if (counts(a)) a.portal->figures["conductance"] = conductance;
}

// Sets `sky` on the portal: the share of its lines that come from outside and meet it first.
void appraise_sky(const LightGrid& grid, const Appraised& a, const std::vector<Appraised>& all) {
  size_t first = 0;
  for (const LineCrossing& c : a.crossings) {
    const LightLine& line = grid.lines[c.line];
    if (!is_under_sky(grid.scene_hash) || !begins_at_border(grid, line)) continue;
    const double here = way_to(a.shape, line).value_or(0);
    first += std::none_of(all.begin(), all.end(), [&](const Appraised& other) {
      return &other != &a && way_to(other.shape, line).value_or(1) < here;
    });
  }
  if (!a.crossings.empty())
    a.portal->figures["sky"] = static_cast<double>(first) / static_cast<double>(a.crossings.size());
}

}  // namespace

void appraise(const LightGrid& grid, std::vector<Portal>& portals) {
  size_t cuts = 1;
  for (const LightLine& l : grid.lines) cuts = std::max<size_t>(cuts, l.cut + 1);
  std::vector<size_t> lines(cuts, 0);
  for (const LightLine& l : grid.lines) ++lines[l.cut];
  std::vector<Appraised> appraised;
  for (Portal& portal : portals) {
    PortalShape shape = shape_of(portal);
    std::vector<LineCrossing> crossings = crossings_of(grid.lines, shape);
    const size_t cut = cut_of(grid.lines, lines, crossings);
    std::erase_if(crossings, [&](const LineCrossing& c) { return grid.lines[c.line].cut != cut; });
    const auto tightness = tightness_of(grid.lines, shape, crossings);
    portal.figures["cut"] = static_cast<double>(cut);
    if (tightness) portal.figures["tightness"] = *tightness;
    appraised.push_back({&portal, std::move(shape), cut, std::move(crossings), tightness});
  }
  if (tells_of_sky(grid))
    for (const Appraised& a : appraised) appraise_sky(grid, a, appraised);
  for (size_t c = 0; c < cuts && c < grid.cuts.size(); ++c)
    appraise_cut(grid, c, lines[c], appraised);
}

}  // namespace tdpt
