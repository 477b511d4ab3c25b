#include "tools/mincut/preview.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/draw/scene_panels.h"
#include "libcommon/math/reach.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {
namespace {

constexpr size_t kMostLines = 300;

// The light's, the camera's, and those between bottlenecks in series.
int regions(const CutFile& cut) {
  return static_cast<int>(cut.cuts.size()) + 1;
}

// Cuts that lie on the light's way to a patch.
int region_of(const CutFile& cut, size_t patch) {
  return std::popcount(cut.sides[patch]);
}

std::string name_of_region(int k, int n) {
  return k == 0       ? "the light's side"
         : k == n - 1 ? "the camera's side"
         : n == 3     ? "between them"
                      : fmt::format("region {}", k);
}

std::string words_for(const CutFile& cut, size_t drawn) {
  if (!cut.bottleneck) return "no bottleneck: " + cut.reason;
  std::vector<std::string> shares;
  for (const Bottleneck& b : cut.cuts) shares.push_back(percent_words(b.conductance));
  return fmt::format("{}{} pivot pairs, {} of them drawn; {} of the smaller side's light {}",
                     cut.cuts.size() > 1 ? fmt::format("{} bottlenecks; ", cut.cuts.size()) : "",
                     draw::number(static_cast<double>(cut.arcs.size())), drawn,
                     fmt::join(shares, ", "),
                     cut.cuts.size() > 1 ? "cross them" : "crosses the cut");
}

// Where the ends of a pivot pair are drawn [metres]; a part of the sky has no position, so its line
// goes a short way towards it.
struct Ends {
  Vec3d from, to;
};

// Length of a line to the sky: a quarter of the patches' extent [metres].
double skyward(const CutFile& cut) {
  std::vector<Vec3d> places;
  for (const Patch& p : cut.patches)
    if (!p.is_sky()) places.push_back(p.centre);
  return 0.25 * length(reach_of(places).size());
}

Ends ends_of(const CutFile& cut, const CutArc& arc, double skyward) {
  const Patch &from = cut.patches[arc.from], &to = cut.patches[arc.to];
  const auto beside = [&](const Patch& p, const Patch& sky) {
    return p.centre + sky_bin_middle(static_cast<uint32_t>(sky.sky)) * skyward;
  };
  return {from.is_sky() ? beside(to, from) : from.centre,
          to.is_sky() ? beside(from, to) : to.centre};
}

// The pivot pairs that are drawn: paler with less capacity, since most viewers of glTF draw lines
// without opacity.
draw::Shape pivot_pairs(const CutFile& cut) {
  using namespace draw;
  Shape pairs{.name = "pivot pairs", .kind = Shape::Kind::lines, .size = 1.1};
  double most = 0;
  for (const CutArc& a : cut.arcs) most = std::max(most, a.capacity);
  const double skyward_line = skyward(cut);
  for (const size_t i : arcs_to_draw(cut, kMostLines)) {
    const Ends ends = ends_of(cut, cut.arcs[i], skyward_line);
    const double strength = std::sqrt(cut.arcs[i].capacity / most);
    pairs.line(
        ends.from, ends.to,
        {mix(kFaint, kPivot, 0.7 + 0.3 * strength), static_cast<float>(0.2 + 0.6 * strength)});
  }
  return pairs;
}

// Where they begin and end on surfaces.
draw::Shape pivots(const CutFile& cut) {
  draw::Shape dots{.name = "pivots", .kind = draw::Shape::Kind::points, .size = 1.6};
  for (const size_t i : arcs_to_draw(cut, kMostLines))
    for (const uint32_t end : {cut.arcs[i].from, cut.arcs[i].to})
      if (!cut.patches[end].is_sky())
        dots.point(cut.patches[end].centre,
                   draw::mix(draw::region(region_of(cut, end), regions(cut)), draw::kInk, 0.7));
  return dots;
}

}  // namespace

CutFile cuts_for(const FoundCuts& found, size_t camera) {
  const CutFile& cut = found.file;
  CutFile own = cut;
  own.cuts.clear();
  own.sides.assign(cut.patches.size(), 0);
  for (size_t c = 0; c < cut.cuts.size(); ++c) {
    if (cut.cuts[c].camera != camera) continue;
    for (size_t i = 0; i < cut.patches.size(); ++i)
      own.sides[i] |= uint64_t{cut.side_of(i, c) == Side::sink} << own.cuts.size();
    own.cuts.push_back(cut.cuts[c]);
  }
  std::erase_if(own.arcs, [&](const CutArc& arc) { return own.crossed(arc) == 0; });
  own.reason = found.cameras[camera].reason;
  own.bottleneck = own.reason.empty();
  if (own.cuts.empty()) own.cuts.emplace_back();
  return own;
}

std::vector<size_t> arcs_to_draw(const CutFile& cut, size_t most) {
  std::vector<size_t> chosen;
  double total = 0, passed = 0;
  for (const CutArc& a : cut.arcs) total += a.capacity;
  const double step = total / static_cast<double>(most);
  double next = 0.5 * step;
  for (size_t i = 0; i < cut.arcs.size(); ++i) {
    passed += cut.arcs[i].capacity;
    if (cut.arcs.size() <= most || passed > next) chosen.push_back(i);
    while (step > 0 && next < passed) next += step;
  }
  return chosen;
}

draw::Drawing cut_preview(const Scene& scene, const Camera& camera, const CutFile& cut,
                          const std::string& cut_name) {
  using namespace draw;
  if (!scene.is_scene_of(cut.scene_hash))
    throw InputError(display_name(cut_name), "", "was made from another scene than " + scene.path);
  Drawing drawing{.title = "mincut   " + base_name(scene.path),
                  .sentence = {},
                  .shapes = {pivot_pairs(cut), pivots(cut)}};
  // Where the light crosses is what a plan should show.
  const Shape& pairs = drawing.shapes[0];
  std::vector<Vec3d> crossings;
  for (size_t i = 0; i < pairs.positions.size(); i += 2)
    crossings.push_back((pairs.positions[i] + pairs.positions[i + 1]) * 0.5);
  drawing.sentence = words_for(cut, crossings.size());
  const int n = regions(cut);
  const PatchLookup patches(scene.frame, cut.grid, cut.patches);
  drawing.panels = scene_panels(
      scene, camera, crossings,
      [&](uint32_t face, const Vec3d& place) {
        const auto patch = patches.at(face, place);
        return patch ? region(region_of(cut, *patch), n) : kClay;
      },
      true);
  for (int k = 0; k < n; ++k) drawing.key.push_back({{region(k, n)}, name_of_region(k, n)});
  drawing.key.insert(drawing.key.end(),
                     {{{kClay}, "no walk came here"},
                      {{kLamp}, "lamps"},
                      {{kPivot}, "pivot pairs, darker with more light, pale where hidden"}});
  return drawing;
}

std::string cut_debug_glb(const CutFile& cut) {
  const int n = regions(cut);
  std::vector<draw::Shape> shapes(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) shapes[static_cast<size_t>(k)].name = name_of_region(k, n);
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const int k = region_of(cut, i);
    if (!cut.patches[i].is_sky())
      draw::add_patch(shapes[static_cast<size_t>(k)], cut.grid, cut.patches[i], draw::region(k, n));
  }
  shapes.push_back(pivot_pairs(cut));
  return draw::debug_glb_bytes(shapes, cut.provenance);
}

}  // namespace tdpt
