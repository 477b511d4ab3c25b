#include "tools/lightgrid/light_lines.h"

#include <cstdlib>

#include <tbb/parallel_for.h>

namespace tdpt {
namespace {
// Rays around each end of a line that vote on which side of the opening it lies.
constexpr int kVotes = 16, kLead = 4;  // a lead that great decides
constexpr int kFewestVotes = 4;
}  // namespace

LightLines::LightLines(const Scene& scene, const Tracer& tracer, const CutFile& cut,
                       const std::string& cut_name)
    : tracer_(tracer), cut_(cut), map_(scene, cut, cut_name), surfaces_(cut.patches.size()) {
  std::vector<bool> needed(cut.patches.size(), false);
  for (const CutArc& arc : cut.arcs) needed[arc.from] = needed[arc.to] = true;
  tbb::parallel_for(size_t{0}, needed.size(), [&](size_t i) {
    if (needed[i]) surfaces_[i] = std::make_unique<PatchSurface>(scene, cut.grid, cut.patches[i]);
  });
  of_cut_.resize(cut.cuts.size());
  for (size_t c = 0; c < cut.cuts.size(); ++c) {
    std::vector<double> weights;
    for (uint32_t i = 0; i < cut.arcs.size(); ++i) {
      const CutArc& arc = cut.arcs[i];
      if (!cut.crosses(arc, c) || surfaces_[arc.from]->empty() || surfaces_[arc.to]->empty())
        continue;
      of_cut_[c].arcs.push_back(i);
      weights.push_back(arc.capacity);
    }
    if (!weights.empty()) of_cut_[c].table = AliasTable(weights);
  }
}

LightLines::Fate LightLines::between_pivots(size_t c, Rng& rng, JoiningLine& line) const {
  const double pick = rng.uniform();
  const CutArc& arc = cut_.arcs[of_cut_[c].arcs[of_cut_[c].table.sample(pick)]];
  line.light = surfaces_[arc.from]->sample(rng);
  line.camera = surfaces_[arc.to]->sample(rng);
  const Vec3d w = line.camera.position - line.light.position;
  if (dot(w, line.light.normal) <= 0 || dot(w, line.camera.normal) >= 0 ||
      !tracer_.visible({line.light.position, line.light.normal},
                       {line.camera.position, line.camera.normal}))
    return Fate::blocked;
  return sees_its_side(c, rng, line.light, Side::source) &&
                 sees_its_side(c, rng, line.camera, Side::sink)
             ? Fate::kept
             : Fate::leak;
}

bool LightLines::sees_its_side(size_t c, Rng& rng, const SurfacePoint& end, Side side) const {
  const Onb<double> frame(end.normal);
  int same = 0, other = 0;
  for (int i = 0; i < kVotes; ++i) {
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3d w = frame.to_world(cosine_hemisphere(u, v));
    Hit hit;
    if (!tracer_.closest({end.position, end.normal}, w, hit)) continue;
    const uint32_t back = dot(hit.normal, w) > 0 ? 1 : 0;
    const auto seen = map_.region_at(2 * hit.triangle + back, hit.position);
    if (!seen) continue;
    ++(CutFile::side(*seen, c) == side ? same : other);
    if (std::abs(same - other) >= kLead || 2 * same > kVotes || 2 * other > kVotes) break;
  }
  return same > other && same + other >= kFewestVotes;
}

std::optional<LightLines::End> LightLines::end_of(const Vec3d& place, const Vec3d& w) const {
  Hit hit;
  if (!tracer_.closest({place}, w, hit)) return {};
  const bool back = dot(hit.normal, w) > 0;
  const auto region = map_.region_at(2 * hit.triangle + (back ? 1 : 0), hit.position);
  if (!region) return {};
  return End{{hit.position, back ? -hit.normal : hit.normal}, *region};
}

LightLines::Through LightLines::through(size_t c, Rng& rng, const Vec3d& place, const Vec3d& w,
                                        JoiningLine& line) const {
  const auto ahead = end_of(place, w), behind = end_of(place, -w);
  if (!ahead || !behind || ahead->point.position == behind->point.position) return Through::unknown;
  const Side side_ahead = CutFile::side(ahead->region, c);
  const Side side_behind = CutFile::side(behind->region, c);
  const bool along = side_behind == Side::source;
  line.light = along ? behind->point : ahead->point;
  line.camera = along ? ahead->point : behind->point;
  if (side_ahead == side_behind) return Through::same_side;
  return sees_its_side(c, rng, line.light, Side::source) &&
                 sees_its_side(c, rng, line.camera, Side::sink)
             ? Through::joins
             : Through::same_side;
}

}  // namespace tdpt
