// Surfaces of a scene in the layout of shaders/shared/path/surface_layout.h: what kernels and their
// scalar build know of materials, textures and faces.
#pragma once
#include <map>
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/coverage_layout.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// Images packed into words, each stored once.
class TexelWords {
 public:
  explicit TexelWords(const Scene& scene) : scene_(scene) {}

  /// Where the image of `map`, which must have one, is stored and how it is looked up.
  shader::TexelGrid grid_of(const TextureMap& map);

  std::vector<uint32_t> words;

 private:
  const Scene& scene_;
  std::map<int32_t, uint32_t> first_;
};

/// The texture coordinate used by an alpha test in floats: 0 for NaN, infinities and anything
/// beyond 1e9 images [texture.h].
float texture_coordinate(double u);

struct CoverageTables {
  std::vector<uint32_t> coverage_of;        ///< per triangle; empty when all are opaque
  std::vector<shader::Coverage> coverages;  ///< of the triangles that are not opaque
  std::vector<uint32_t> texels;             ///< of the images that they use

  /// Whether the coverage of some surface depends on a texture.
  bool textured() const;
};

/// Panes count as opaque: either their glass has been opened (open_glass()), or another table holds
/// them.
CoverageTables make_coverages(const Scene& scene);
/// The same, but the texels are added to `words` instead.
CoverageTables make_coverages(const Scene& scene, TexelWords& words);

/// Features that only some scenes use: specialisation constants of the same names in its kernels
/// [shaders/shared/path/surface.h].
struct SurfaceFeatures {
  bool layers = false, normals = false, textures = false, colours = false, coats = false,
       sheen = false, transmission = false, absorption = false, panes = false, coverage = false,
       coverage_textures = false;
};

/// Tables may be empty if nothing reads them.
struct SurfaceTables {
  std::vector<shader::Face> faces;                 ///< per triangle
  std::vector<shader::SurfaceMaterial> materials;  ///< as Scene::materials
  std::vector<uint32_t> material_maps;             ///< MAPS_OF_MATERIAL per material
  std::vector<shader::SurfaceMap> maps;
  std::vector<shader::FaceCorners> face_corners;            ///< per triangle, or empty
  std::vector<shader::CornerAttributes> corner_attributes;  ///< per vertex, or empty
  std::vector<uint32_t> texel_words;
  CoverageTables coverage;  ///< without texels: it uses those above
  SurfaceFeatures features;
};

/// Its factors, without maps.
shader::SurfaceMaterial surface_material(const Material& m);

/// `radiance_unit`: a power of two; radiance in the tables is divided by it.
SurfaceTables make_surfaces(const Scene& scene, double radiance_unit);

}  // namespace tdpt
