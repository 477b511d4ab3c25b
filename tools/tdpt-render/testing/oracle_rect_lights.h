// The slow, obvious reference for next_event.h: the light of a rectangle at a point, from its four
// corners alone. For tests.
#pragma once
#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt::oracle {

/// p_A of x_0, on a rectangular light, as a next event among rectangular lights at x_1 of a path
/// that goes on to x_2.
double rect_light_pdf_A(const Vista& vista, const Vertex& x0, const Vertex& x1, const Vertex& x2);

}  // namespace tdpt::oracle
