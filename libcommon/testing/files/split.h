// Subdivides each triangle of a scene into four.
#pragma once
#include <string>

namespace tdpt::testing {

/// The scene `glb` (the bytes of a .glb) with the midpoints of all edges as new vertices and four
/// triangles for each one: the same surface. Neighbours share midpoints, so connected surfaces stay
/// connected. Attributes are averaged as numbers. Supports triangle lists with float attributes,
/// without sparse accessors and morph targets; throws std::invalid_argument otherwise.
std::string split_in_four(const std::string& glb);

}  // namespace tdpt::testing
