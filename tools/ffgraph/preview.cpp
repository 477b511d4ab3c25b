#include "tools/ffgraph/preview.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/draw/scene_sheet.h"
#include "libcommon/formats/debug_glb.h"
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

void paint_network(draw::SceneSheet& sheet, const Scene& scene, const DimacsFile& file,
                   bool triangles) {
  const std::vector<Reach> reached = reach_of_patches(file, triangles);
  const draw::PatchLookup patches(scene.frame, file.grid, file.patches);
  sheet.paint([&](uint32_t face, const Vec3d& place) {
    const auto patch = patches.at(face, place);
    return patch ? draw::reach(reached[*patch].light, reached[*patch].camera) : draw::kClay;
  });
}

namespace {
// Where walks from both ends came: what a plan should show.
std::vector<Vec3d> places_of_both(const DimacsFile& file, const std::vector<Reach>& reached) {
  std::vector<Vec3d> places;
  for (size_t i = 0; i < reached.size(); ++i)
    if (reached[i].light > 0 && reached[i].camera > 0 && !file.patches[i].is_sky())
      places.push_back(file.patches[i].centre);
  return places;
}
}  // namespace

draw::Canvas network_preview(const Scene& scene, const Camera& camera, const DimacsFile& file,
                             bool triangles) {
  using namespace draw;
  const std::vector<Reach> reached = reach_of_patches(file, triangles);
  size_t both = 0;
  for (const Reach& r : reached) both += r.light > 0 && r.camera > 0;
  const std::string sentence = fmt::format(
      "{} {}, {} of them {}; {} arcs", number(static_cast<double>(reached.size())),
      triangles ? "triangles" : "patches", number(static_cast<double>(both)),
      triangles ? "both lit and seen" : "reached by walks from both ends of the light's way",
      number(static_cast<double>(file.network.arcs.size())));
  SceneSheet sheet(scene, camera, "ffgraph   " + base_name(scene.path), sentence,
                   places_of_both(file, reached), 62);
  paint_network(sheet, scene, file, triangles);
  const Box legend = sheet.legend();
  const Box square{legend.x, legend.y + 4, 56, 56};
  if (triangles) {
    key(sheet.canvas(), {legend.x, legend.y + 28},
        {{kLight, "S_d: lit directly"},
         {kCamera, "S_p: seen by the camera"},
         {kBoth, "both"},
         {kClay, "neither"},
         {kLamp, "lamps"}});
  } else {
    reach_square(sheet.canvas(), square, "right: grade E of walks from the light",
                 "up: grade W of walks from the camera");
    key(sheet.canvas(), {legend.x + 460, legend.y + 38},
        {{kLight, "the light's"},
         {kCamera, "the camera's"},
         {kBoth, "both, fully"},
         {kClay, "no walk came here"},
         {kLamp, "lamps"}});
  }
  return sheet.finish();
}

std::string network_debug_glb(const Scene& scene, const DimacsFile& file, bool triangles) {
  const std::vector<Reach> reached = reach_of_patches(file, triangles);
  DebugMesh mesh;
  mesh.name = triangles ? "triangles" : "patches";
  for (size_t i = 0; i < reached.size(); ++i) {
    const Patch& p = file.patches[i];
    if (p.is_sky()) continue;
    const auto colour = draw::bytes_of(draw::reach(reached[i].light, reached[i].camera));
    const double cell = std::ldexp(file.grid.base_cell, -2 * p.level);
    if (!triangles) {
      // Just in front of the surface, so that scene and patches can be shown together.
      mesh.square(p.centre + p.normal * (0.01 * cell), p.normal, 0.94 * cell, colour);
      continue;
    }
    const uint32_t t = p.faces.front() / 2;
    const Vec3d off = p.normal * (5e-4 * cell);
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = scene.frame.to_metres(Vec3d(scene.vertex(t, k))) + off;
    if (p.faces.front() % 2 == 1) std::swap(corner[1], corner[2]);
    mesh.triangle(corner[0], corner[1], corner[2], colour);
  }
  return debug_glb_bytes({mesh}, file.provenance);
}

}  // namespace tdpt
