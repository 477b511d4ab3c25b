#include "tools/ffgraph/preview.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/draw/scene_panels.h"
#include "libcommon/flow/potential_sweep.h"

namespace tdpt {

std::vector<Reach> reach_of_patches(const DimacsFile& file, bool triangles) {
  std::vector<uint32_t> patch(file.network.nodes, UINT32_MAX);
  for (uint32_t i = 0; i < file.patches.size(); ++i) patch[file.patches[i].node - 1] = i;
  std::vector<Reach> reach(file.patches.size());
  const auto share = [&](uint32_t i, const FlowArc& arc) {
    if (triangles) return arc.capacity > 0 ? 1.0 : 0.0;
    const double samples = file.patches[i].samples * file.scale;
    return samples > 0 ? std::min(1.0, static_cast<double>(arc.capacity) / samples) : 0.0;
  };
  for (const FlowArc& arc : file.network.arcs) {
    if (arc.from == file.network.source && patch[arc.to] != UINT32_MAX)
      reach[patch[arc.to]].light = share(patch[arc.to], arc);
    // All sinks; of several cameras the one that reaches a patch best counts.
    if (patch[arc.from] != UINT32_MAX && arc.to != file.network.source &&
        patch[arc.to] == UINT32_MAX) {
      double& camera = reach[patch[arc.from]].camera;
      camera = std::max(camera, share(patch[arc.from], arc));
    }
  }
  // With a sky the source feeds no surface; the walks show which ones the light reaches.
  if (!file.walks.empty() && std::any_of(file.patches.begin(), file.patches.end(),
                                         [](const Patch& p) { return p.is_sky(); })) {
    std::vector<double> hits, samples;
    for (size_t i = 0; i < reach.size(); ++i) {
      hits.push_back(file.walks[i].light);
      samples.push_back(file.patches[i].samples);
    }
    const std::vector<double> grades = terminal_grades(hits, samples);
    for (size_t i = 0; i < reach.size(); ++i)
      if (!file.patches[i].is_sky()) reach[i].light = grades[i];
  }
  return reach;
}

draw::Drawing network_preview(const Scene& scene, const Camera& camera, const DimacsFile& file,
                              bool triangles) {
  using namespace draw;
  const std::vector<Reach> reached = reach_of_patches(file, triangles);
  // Where walks from both ends came: what a plan should show.
  std::vector<Vec3d> places;
  double both = 0;
  for (size_t i = 0; i < reached.size(); ++i) {
    if (!(reached[i].light > 0 && reached[i].camera > 0)) continue;
    ++both;
    if (!file.patches[i].is_sky()) places.push_back(file.patches[i].centre);
  }
  Drawing drawing{.title = "ffgraph   " + base_name(scene.path),
                  .sentence = fmt::format(
                      "{} {}, {} of them {}; {} arcs", number(static_cast<double>(reached.size())),
                      triangles ? "triangles" : "patches", number(both),
                      triangles ? "both lit and seen" : "reached by walks from both ends",
                      number(static_cast<double>(file.network.arcs.size())))};
  const PatchLookup patches(scene.frame, file.grid, file.patches);
  drawing.panels = scene_panels(
      scene, camera, places,
      [&](uint32_t face, const Vec3d& place) {
        const auto patch = patches.at(face, place);
        return patch ? reach(reached[*patch].light, reached[*patch].camera) : kClay;
      },
      true);
  if (triangles) {
    drawing.key = {{{kLight}, "S_d: lit directly"},
                   {{kCamera}, "S_p: seen by the camera"},
                   {{kBoth}, "both"},
                   {{kClay}, "neither"}};
  } else {
    std::vector<Ink> light, from_camera, from_both;
    for (int k = 0; k <= 8; ++k) {
      light.push_back(reach(k / 8.0, 0));
      from_camera.push_back(reach(0, k / 8.0));
      from_both.push_back(reach(k / 8.0, k / 8.0));
    }
    drawing.key = {{light, "grade E of walks from the light, 0 to 1"},
                   {from_camera, "grade W of walks from the camera, 0 to 1"},
                   {from_both, "both alike"},
                   {{kClay}, "no walk came here"}};
  }
  drawing.key.push_back({{kLamp}, "lamps"});
  return drawing;
}

std::string network_debug_glb(const Scene& scene, const DimacsFile& file, bool triangles) {
  const std::vector<Reach> reached = reach_of_patches(file, triangles);
  draw::Shape shape{.name = triangles ? "triangles" : "patches"};
  for (size_t i = 0; i < reached.size(); ++i) {
    const Patch& p = file.patches[i];
    if (p.is_sky()) continue;
    const draw::Ink c = draw::reach(reached[i].light, reached[i].camera);
    if (!triangles) {
      draw::add_patch(shape, file.grid, p, c);
      continue;
    }
    const uint32_t t = p.faces.front() / 2;
    const Vec3d off = p.normal * (5e-4 * std::ldexp(file.grid.base_cell, -2 * p.level));
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = scene.frame.to_metres(Vec3d(scene.vertex(t, k))) + off;
    if (p.faces.front() % 2 == 1) std::swap(corner[1], corner[2]);
    shape.triangle(corner[0], corner[1], corner[2], c);
  }
  return draw::debug_glb_bytes({shape}, file.provenance);
}

}  // namespace tdpt
