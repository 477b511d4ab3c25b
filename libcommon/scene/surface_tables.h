// Surfaces of a scene in the layout of shaders/shared/path/surface_layout.h: what kernels, and
// their scalar build, know of materials, textures and faces.
#pragma once
#include <vector>

#include "libcommon/scene/coverage_tables.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// What a scene has of what only some have: constants of the same names of its kernels
/// [shaders/shared/path/surface.h].
struct SurfaceFeatures {
  bool layers = false, normals = false, textures = false, colours = false, coats = false,
       sheen = false, transmission = false, absorption = false, panes = false, coverage = false,
       coverage_textures = false;
};

/// Tables may be empty where nothing asks them.
struct SurfaceTables {
  std::vector<shader::Face> faces;                 ///< of each triangle
  std::vector<shader::SurfaceMaterial> materials;  ///< as Scene::materials
  std::vector<uint32_t> material_maps;             ///< MAPS_OF_MATERIAL of each
  std::vector<shader::SurfaceMap> maps;
  std::vector<shader::FaceCorners> face_corners;            ///< of each triangle, or empty
  std::vector<shader::CornerAttributes> corner_attributes;  ///< of each vertex, or empty
  std::vector<uint32_t> texel_words;
  CoverageTables coverage;  ///< without texels: those above are theirs, too
  SurfaceFeatures features;
};

/// Its factors, without maps.
shader::SurfaceMaterial surface_material(const Material& m);

/// `radiance_unit`: a power of two; radiance in the tables is over it.
SurfaceTables make_surfaces(const Scene& scene, double radiance_unit);

}  // namespace tdpt
