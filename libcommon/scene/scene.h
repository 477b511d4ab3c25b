// A scene as the tools see it: triangles in a canonical frame, materials, cameras.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Canonical frame: canonical = (metres - centre) * scale. `scale` is a power of two such that the
/// longest side of the bounding box becomes a length in (1, 2]; `centre` is the middle of the box.
/// Rays are traced in it, so a scene in other units or far from the origin loses nothing; areas and
/// distances in it are NOT metres. Radiance is the same in both.
struct Frame {
  Vec3d centre{};
  double scale = 1;
  Vec3d to_canonical(const Vec3d& metres) const { return (metres - centre) * scale; }
  Vec3d to_metres(const Vec3d& canonical) const { return canonical / scale + centre; }
};

struct Material {
  std::string name;
  Rgb albedo{0.8f, 0.8f, 0.8f};  ///< diffuse reflectance, each in [0,1]
  Rgb emission{};                ///< radiance [W/m2/sr], on the front side only unless double_sided
  bool double_sided = false;
};

/// Counter-clockwise seen from the front: normal ~ cross(p1-p0, p2-p0).
struct Triangle {
  std::array<uint32_t, 3> vertex;  ///< into Scene::positions
  uint32_t material;               ///< into Scene::materials
};

/// Pinhole camera; place and axes in the canonical frame, axes unit and orthogonal.
struct Camera {
  std::string name;
  Vec3d position, right, up, forward;
  double yfov = 0.8;  ///< full vertical angle [rad]
  double aspect = 0;  ///< width / height; 0: the scene does not say
};

struct Scene {
  std::string path;  ///< as given, for messages
  std::string hash;  ///< content hash of the file and of all buffers it reads
  Frame frame;
  std::vector<Vec3f> positions;  ///< canonical
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<Camera> cameras;
  std::vector<std::string> warnings;  ///< sentences: what was approximated or left out

  Vec3f vertex(uint32_t triangle, int corner) const {
    return positions[triangles[triangle].vertex[corner]];
  }
  const Material& material_of(uint32_t triangle) const {
    return materials[triangles[triangle].material];
  }
  /// Camera called `name`; the first one for "". Throws InputError naming those there are, or
  /// when it stands more than 1e6 times the scene's size away.
  const Camera& camera(const std::string& name) const;
};

/// Geometric quantities of one triangle, canonical frame, computed in double precision.
struct TriangleShape {
  Vec3d p0, e1, e2;  ///< corner and edges p1-p0, p2-p0
  Vec3d normal;      ///< unit, front side; zero when degenerate
  double area;
};
TriangleShape shape_of(const Scene& scene, uint32_t triangle);

/// Reads a glTF 2.0 scene (.glb or .gltf, "-": .glb from standard input). Triangles without area
/// are dropped. Throws InputError "file:place: message" for everything that is wrong; never reads
/// outside a buffer, never opens a file outside the scene's folder.
Scene read_gltf(const std::string& path);

}  // namespace tdpt
