// The tables that the text of surfaces reads [shaders/shared/path/surface_layout.h], the same of
// every scene; each is made on first need.
#pragma once
#include <span>

namespace tdpt {

/// surface_curves[]; in about 20 ms.
std::span<const double> surface_curves();
/// sheen_curves[]; in about 100 ms.
std::span<const double> sheen_curves();

}  // namespace tdpt
