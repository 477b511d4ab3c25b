// A scene with each of its triangles split in four.
#pragma once
#include <string>

namespace tdpt::testing {

/// The scene of `glb` (the bytes of a .glb) with the midpoints of all edges as new vertices and
/// four triangles for each one: the same surface. Neighbours share their midpoint, so what was
/// joined stays joined. Attributes are halved as numbers. Knows triangle lists with attributes of
/// floats, without sparse accessors and morph targets; throws std::invalid_argument for all else.
std::string split_in_four(const std::string& glb);

}  // namespace tdpt::testing
