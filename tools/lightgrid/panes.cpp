// Finds the sheets of solid glass: pairs of flat faces that look away from each other.
//
// Method: triangles of glass are summed by plane, in cells of a degree and a tenth of a millimetre;
// each face, the largest first, is paired with the nearest face behind it that looks the other way.
#include "tools/lightgrid/panes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace tdpt {
namespace {

constexpr double kSheet = 0.5;                 // of the width: thicker glass is a block
constexpr double kParallel = 0.99939;          // cosine of two degrees
constexpr double kCell = 1 / 57.3;             // a degree
constexpr double kDepth = 1e-4;                // of a cell of planes [m]
constexpr size_t kMostFaces = 8 * kMostPanes;  // that are looked at, the largest

// Triangles in one plane that face one way; n is as long as their area.
struct Face {
  Vec3d n{}, moment{};
  Vec3d normal() const { return normalize(n); }
  Vec3d place() const { return moment / length(n); }
};

// Of the glass, the largest first.
std::vector<Face> flat_faces(const Scene& scene) {
  std::map<std::array<long, 4>, Face> by_plane;
  const size_t surfaces = std::min<size_t>(scene.dome, scene.triangles.size());
  for (size_t t = 0; t < surfaces; ++t) {
    const Material& m = scene.materials[scene.triangles[t].material];
    if (!m.solid || !(m.transmission > 0)) continue;
    const TriangleShape s = shape_of(scene, static_cast<uint32_t>(t));
    if (!(s.area > 0)) continue;
    const Vec3d middle = scene.frame.to_metres(s.p0 + (s.e1 + s.e2) / 3);
    const auto cell = [](double v, double size) { return std::lround(v / size); };
    Face& face = by_plane[{cell(s.normal.x, kCell), cell(s.normal.y, kCell),
                           cell(s.normal.z, kCell), cell(dot(s.normal, middle), kDepth)}];
    face.n += s.normal * s.area;
    face.moment += middle * s.area;
  }
  std::vector<Face> faces;
  for (const auto& [plane, face] : by_plane) faces.push_back(face);
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return length(a.n) > length(b.n); });
  if (faces.size() > kMostFaces) faces.resize(kMostFaces);
  return faces;
}

}  // namespace

std::vector<Pane> solid_panes(const Scene& scene) {
  const std::vector<Face> faces = flat_faces(scene);
  std::vector<Pane> panes;
  std::vector<uint8_t> paired(faces.size(), 0);
  for (size_t f = 0; f < faces.size() && panes.size() < kMostPanes; ++f) {
    const Vec3d n = faces[f].normal(), at = faces[f].place();
    double thick = kSheet * std::sqrt(length(faces[f].n)) / scene.frame.scale;
    size_t other = f;
    for (size_t g = 0; g < faces.size(); ++g)
      if (dot(faces[g].normal(), n) < -kParallel)
        if (const double t = dot(at - faces[g].place(), n); t > 0 && t < thick)
          thick = t, other = g;
    if (other == f || paired[f]) continue;
    paired[f] = paired[other] = 1;
    panes.push_back({at, at - n * thick});
  }
  return panes;
}

}  // namespace tdpt
