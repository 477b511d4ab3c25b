// The curves of shaders/shared/path/surface_layout.h, from the tables of the renderer that counts
// in doubles.
#pragma once
#include <vector>

namespace tdpt {

/// surface_curves[], the same of every scene.
std::vector<float> make_surface_curves();

}  // namespace tdpt
