// Guesses the unit in which a portal was drawn: one drawn in centimetres lies far outside the scene
// or is far too large, and would fill an opening if it were scaled.
//
// Method: rays in the portal's plane, from its centre outwards, hit the rim of an opening:
//   fit = share of the rays whose first surface lies between 0.5 and 1.5 times as far as the
//         portal's own rim.
#pragma once
#include <string>

#include "libcommon/formats/portal.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

/// Fit of the portal with its coordinates multiplied by `factor` [m]: from the centre of its
/// largest triangle, in its plane.
double fit_of(const Portal& portal, double factor, const Tracer& tracer, const Frame& frame);

/// "seems drawn in centimetres" or the like, for the unit with the best fit, if that is at least
/// 1/2 and better than without scaling; otherwise empty.
std::string unit_words(const Portal& portal, const Tracer& tracer, const Frame& frame);

}  // namespace tdpt
