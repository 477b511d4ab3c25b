// Tables that the surface code reads [shaders/shared/path/surface_layout.h]. They are the same for
// every scene and computed on first use.
#pragma once
#include <span>

namespace tdpt {

/// surface_curves[]; takes about 20 ms.
std::span<const double> surface_curves();
/// sheen_curves[]; takes about 100 ms.
std::span<const double> sheen_curves();

}  // namespace tdpt
