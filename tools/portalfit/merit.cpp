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
#include <algorithm>
#include <numbers>
#include <optional>
#include <set>

#include "libcommon/scene/scene.h"
#include "tools/portalfit/plane.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {
namespace {

constexpr double kBorder = 0.01;  // of a voxel: rounding of a line's end

// A line that crosses a portal along its normal.
struct LineCrossing {
  uint32_t line;
  Vec2d at;  // in the plane of the portal's shape
};

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
size_t cut_of(const std::vector<LightLine>& lines, const std::vector<double>& of_cut,
              const std::vector<LineCrossing>& crossings) {
  std::vector<double> share(of_cut.size(), 0);
  for (const LineCrossing& c : crossings) ++share[lines[c.line].cut];
  for (size_t k = 0; k < share.size(); ++k) share[k] /= std::max(of_cut[k], 1.0);
  return static_cast<size_t>(std::max_element(share.begin(), share.end()) - share.begin());
}

// `crossings`: of one cut, at least one.
double tightness_of(const std::vector<LightLine>& lines, const PortalShape& shape,
                    const std::vector<LineCrossing>& crossings) {
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

// Where the line crosses the shape, of its length from the light.
std::optional<double> way_to(const PortalShape& shape, const LightLine& line) {
  const auto at = crossing(shape.plane, line);
  if (!at || !contains(shape, *at)) return {};
  const double before = dot(shape.plane.o - line.light, shape.plane.n);
  return before / dot(line.camera - line.light, shape.plane.n);
}

// Share of the lines that come from outside and meet this shape before all others.
double sky_share(const LightGrid& grid, const PortalShape& shape,
                 const std::vector<LineCrossing>& crossings, const std::vector<PortalShape>& all) {
  const auto meets_first = [&](const LineCrossing& c) {
    const LightLine& line = grid.lines[c.line];
    const double here = way_to(shape, line).value_or(0);
    return begins_at_border(grid, line) &&
           std::none_of(all.begin(), all.end(), [&](const PortalShape& other) {
             return &other != &shape && way_to(other, line).value_or(1) < here;
           });
  };
  if (!is_under_sky(grid.scene_hash)) return 0;
  const auto first = std::count_if(crossings.begin(), crossings.end(), meets_first);
  return static_cast<double>(first) / static_cast<double>(crossings.size());
}

}  // namespace

void appraise(const LightGrid& grid, std::vector<Portal>& portals) {
  // Tables without walls have the box of the lines alone: it does not say what comes from the sky.
  const bool tells_of_sky =
      !grid.scene_hash.empty() && std::find(grid.air.begin(), grid.air.end(), 0) != grid.air.end();
  std::vector<double> lines(1, 0);  // of each cut
  for (const LightLine& l : grid.lines) {
    if (l.cut >= lines.size()) lines.resize(l.cut + 1, 0);
    ++lines[l.cut];
  }
  std::vector<PortalShape> shapes;
  for (const Portal& portal : portals) shapes.push_back(shape_of(portal));
  std::vector<std::set<uint32_t>> passing(lines.size());  // of each cut the lines through portals
  std::vector<size_t> cuts;                               // of the portals
  for (size_t p = 0; p < portals.size(); ++p) {
    std::vector<LineCrossing> crossings = crossings_of(grid.lines, shapes[p]);
    const size_t cut = cuts.emplace_back(cut_of(grid.lines, lines, crossings));
    std::erase_if(crossings, [&](const LineCrossing& c) { return grid.lines[c.line].cut != cut; });
    auto& figures = portals[p].figures;
    figures["cut"] = static_cast<double>(cut);
    if (crossings.empty()) continue;
    figures["tightness"] = tightness_of(grid.lines, shapes[p], crossings);
    if (tells_of_sky) figures["sky"] = sky_share(grid, shapes[p], crossings, shapes);
    for (const LineCrossing& c : crossings) passing[cut].insert(c.line);
  }
  // Lines that end on a jamb before they cross count for flux_share, but not for conductance:
  // tightness / conductance is then the room's surface over the opening, wherever the cut runs.
  for (size_t p = 0; p < portals.size(); ++p)
    if (const size_t c = cuts[p]; c < grid.cuts.size() && portals[p].figures.contains("tightness"))
      portals[p].figures["conductance"] = grid.cuts[c].conductance * grid.cuts[c].kept *
                                          static_cast<double>(passing[c].size()) / lines[c];
}

}  // namespace tdpt
