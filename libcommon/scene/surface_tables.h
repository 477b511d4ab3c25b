// Surfaces of a scene in the layout of shaders/shared/path/surface_layout.h: what kernels and their
// scalar build know of materials, textures and faces.
#pragma once
#include <vector>

#include "libcommon/scene/coverage_tables.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

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
