#include "tools/mincut/preview.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/draw/scene_sheet.h"
#include "libcommon/formats/debug_glb.h"
#include "libcommon/math/reach.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {
namespace {

constexpr size_t kMostLines = 200, kMostGlbLines = 2000;

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
  std::vector<WeightedPlace> places;
  for (const Patch& p : cut.patches)
    if (!p.is_sky()) places.push_back({p.centre, 1});
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

double largest_capacity(const CutFile& cut) {
  double most = 0;
  for (const CutArc& a : cut.arcs) most = std::max(most, a.capacity);
  return most;
}

// Where the light crosses: midpoints of the pivot pairs that are drawn [metres].
std::vector<Vec3d> crossings(const CutFile& cut) {
  std::vector<Vec3d> places;
  for (const size_t i : arcs_to_draw(cut, kMostLines)) {
    const Ends ends = ends_of(cut, cut.arcs[i], 0);
    places.push_back((ends.from + ends.to) * 0.5);
  }
  return places;
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

void paint_cut(draw::SceneSheet& sheet, const Scene& scene, const CutFile& cut) {
  using namespace draw;
  const int n = regions(cut);
  const PatchLookup patches(scene.frame, cut.grid, cut.patches);
  sheet.paint([&](uint32_t face, const Vec3d& place) {
    const auto patch = patches.at(face, place);
    return patch ? region(region_of(cut, *patch), n) : kClay;
  });
  const double most = largest_capacity(cut);
  const auto lines = arcs_to_draw(cut, kMostLines);
  const double skyward_line = skyward(cut);
  for (const size_t i : lines) {
    const Ends ends = ends_of(cut, cut.arcs[i], skyward_line);
    sheet.line(ends.from, ends.to, 1.1, kPivot,
               0.12 + 0.6 * std::sqrt(cut.arcs[i].capacity / most));
  }
  for (const size_t i : lines)
    for (const uint32_t end : {cut.arcs[i].from, cut.arcs[i].to})
      if (!cut.patches[end].is_sky())
        sheet.dot(cut.patches[end].centre, 1.6, mix(region(region_of(cut, end), n), kInk, 0.7),
                  0.9);
}

draw::Canvas cut_preview(const Scene& scene, const Camera& camera, const CutFile& cut,
                         const std::string& cut_name) {
  using namespace draw;
  if (!scene.is_scene_of(cut.scene_hash))
    throw InputError(display_name(cut_name), "", "was made from another scene than " + scene.path);
  SceneSheet sheet(scene, camera, "mincut   " + base_name(scene.path),
                   words_for(cut, arcs_to_draw(cut, kMostLines).size()), crossings(cut),
                   regions(cut) > 3 ? 30 + kKeyRow : 30);
  paint_cut(sheet, scene, cut);
  const int n = regions(cut);
  std::vector<std::pair<Ink, std::string>> entries;
  for (int k = 0; k < n; ++k) entries.emplace_back(region(k, n), name_of_region(k, n));
  entries.emplace_back(kClay, "no walk came here");
  entries.emplace_back(kLamp, "lamps");
  entries.emplace_back(kPivot, "pivot pairs, darker with more light, pale where hidden");
  key(sheet.canvas(), {sheet.legend().x, sheet.legend().y + 22}, entries);
  return sheet.finish();
}

std::string cut_debug_glb(const CutFile& cut, DebugLines lines) {
  const int n = regions(cut);
  std::vector<DebugMesh> meshes(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) meshes[static_cast<size_t>(k)].name = name_of_region(k, n);
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const Patch& p = cut.patches[i];
    if (p.is_sky()) continue;
    const double cell = std::ldexp(cut.grid.base_cell, -2 * p.level);
    const int k = region_of(cut, i);
    meshes[static_cast<size_t>(k)].square(p.centre + p.normal * (0.01 * cell), p.normal,
                                          0.94 * cell, draw::bytes_of(draw::region(k, n)));
  }
  DebugMesh pairs{.name = "pivot pairs", .kind = DebugMesh::Kind::lines};
  const double most = largest_capacity(cut);
  const double skyward_line = skyward(cut);
  for (const size_t i : arcs_to_draw(cut, kMostGlbLines)) {
    const CutArc& a = cut.arcs[i];
    // Most viewers draw lines without opacity: little capacity is pale instead.
    const draw::Ink c =
        draw::mix(draw::kFaint, draw::kPivot, 0.25 + 0.75 * std::sqrt(a.capacity / most));
    const Ends ends = ends_of(cut, a, skyward_line);
    pairs.line(ends.from, ends.to, draw::bytes_of(c), draw::bytes_of(c));
  }
  meshes.push_back(std::move(pairs));
  return debug_glb_bytes(meshes, cut.provenance, lines);
}

}  // namespace tdpt
