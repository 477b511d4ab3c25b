// pbrt's shapes as meshes.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

/// A mesh of the scene whose front is the side of pbrt's normal without ReverseOrientation.
struct Geometry {
  size_t mesh = 0;
  Affine to_object{};
  std::string name;
  size_t faces = 1;     ///< pbrt's own shapes that it consists of
  bool is_mesh = true;  ///< areas are measured in the world, else in the object's space
};

class Geometries {
 public:
  /// None for a shape that is lost.
  std::optional<Geometry> read(Context& context, const std::string& kind, const Parameters& list);

 private:
  std::map<std::string, size_t> known_;  // meshes by file or kind
};

/// Surface of the mesh after the map.
double area_of(const Mesh& mesh, const Affine& map);

}  // namespace tdpt::foreign::pbrt
