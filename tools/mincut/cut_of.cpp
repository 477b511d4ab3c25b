#include "tools/mincut/cut_of.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

namespace tdpt {
namespace {

struct Sides {
  double area[2] = {0, 0};    // in samples
  double volume[2] = {0, 0};  // capacity of the arcs that leave a patch of this side for a patch
  double crossing = 0;        // patch-to-patch capacity of the cut
};

std::string why_no_bottleneck(const Sides& s, double conductance, const CutLimits& limits) {
  const double area = s.area[0] + s.area[1];
  const int small = s.area[0] < s.area[1] ? 0 : 1;
  if (s.area[small] < limits.least_area * area)
    return fmt::format(
        "the {} side of the cut has {:.1f} % of the surface, less than {:.1f} %: light "
        "and camera share one open space",
        small == 0 ? "light's" : "camera's", 100 * s.area[small] / area, 100 * limits.least_area);
  if (s.crossing <= 0) return "no light passes from the light's side of the cut to the camera's";
  if (conductance > limits.largest_conductance)
    return fmt::format(
        "{:.2g} of the smaller side's light crosses the cut, more than {:.2g}: the opening is wide",
        conductance, limits.largest_conductance);
  return "";
}

}  // namespace

CutFile cut_of(const DimacsFile& problem, const MaxFlow& flow, const CutLimits& limits) {
  CutFile cut;
  cut.scene_hash = problem.scene_hash;
  cut.grid = problem.grid;
  cut.patches = problem.patches;
  cut.flow = static_cast<double>(flow.value) / problem.scale;
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> patch_of(problem.network.nodes, kNone);
  Sides sides;
  for (uint32_t i = 0; i < cut.patches.size(); ++i) {
    const uint32_t v = cut.patches[i].node - 1;
    patch_of[v] = i;
    cut.side.push_back(flow.source_side[v] ? Side::source : Side::sink);
    sides.area[flow.source_side[v] ? 0 : 1] += cut.patches[i].samples;
  }
  for (const FlowArc& a : problem.network.arcs) {
    const uint32_t from = patch_of[a.from], to = patch_of[a.to];
    if (from == kNone || to == kNone || from == to || a.capacity == 0) continue;
    const double capacity = static_cast<double>(a.capacity) / problem.scale;
    sides.volume[cut.side[from] == Side::source ? 0 : 1] += capacity;
    if (cut.side[from] != Side::source || cut.side[to] != Side::sink) continue;
    sides.crossing += capacity;
    cut.arcs.push_back({from, to, capacity});
  }
  const double smaller = std::min(sides.volume[0], sides.volume[1]);
  cut.conductance = smaller > 0 ? sides.crossing / smaller : 1;
  cut.reason = why_no_bottleneck(sides, cut.conductance, limits);
  cut.bottleneck = cut.reason.empty();
  return cut;
}

std::string plain_cut_text(const DimacsFile& problem, const MaxFlow& flow,
                           const Provenance& provenance) {
  std::string out = "c tdpt cut 1\n";
  const auto to = std::back_inserter(out);
  for (const std::string& line : provenance.lines) fmt::format_to(to, "c {}\n", line);
  fmt::format_to(to, "s {}\n", flow.value);
  for (uint32_t v = 0; v < problem.network.nodes; ++v)
    fmt::format_to(to, "n {} {}\n", v + 1, flow.source_side[v] ? 's' : 't');
  for (const FlowArc& a : problem.network.arcs)
    if (flow.source_side[a.from] && !flow.source_side[a.to])
      fmt::format_to(to, "a {} {} {}\n", a.from + 1, a.to + 1, a.capacity);
  return out;
}

}  // namespace tdpt
