// Tungsten's shapes as placed meshes, by src/core/primitives/*.cpp. Internal to this room.
#pragma once
#include <optional>

#include "tools/tdpt-import/tungsten/json.h"

namespace tdpt::foreign::tungsten {

struct Placed {
  Mesh (*mesh)();
  Affine to_world;
  double more_area = 0;  ///< counts for the power of its light, though nothing shines there
};

/// Empty for other types.
std::optional<Placed> placed(const Node& node, const std::string& type, const Affine& map);

/// The rotation of a map: its axes at length 1.
Affine rotation_in(const Affine& map, const Node& node);

}  // namespace tdpt::foreign::tungsten
