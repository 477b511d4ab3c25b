// In which unit a portal was drawn: one that was drawn in centimetres stands far outside, or is far
// too large, and would fill an opening if it were scaled.
//
// Method: rays in the portal's plane, from its middle outwards, meet the rim of an opening:
//   fit = share of the rays whose first surface lies between 0.5 and 1.5 times as far as the
//         portal's own rim.
#pragma once
#include <string>

#include "libcommon/formats/portal.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

/// Of the portal with its places multiplied by `factor` [m]: from the middle of its largest
/// triangle, in its plane.
double fit_of(const Portal& portal, double factor, const Tracer& tracer, const Frame& frame);

/// "seems drawn in centimetres" or the like, of the unit in which it fits best and at least by half
/// of the rays, and better than as it is; empty: in none.
std::string unit_words(const Portal& portal, const Tracer& tracer, const Frame& frame);

}  // namespace tdpt
