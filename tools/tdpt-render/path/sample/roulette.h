// Russian roulette: how walks end where no length is set.
//
// Method: a walk goes on at a vertex with the probability of its albedo, so that what it carries
// neither fades nor grows, and the mean number of bounces in a closed room of albedo a is 1/(1-a).
// The first vertex always goes on: z_1, since a pixel is as dark as what it sees, and the error
// of a picture is relative; y_1, for as much. More or fewer of them, and survival by other powers
// of the albedo, change the time and the variance by the same factor: error x work is flat.
//
// Survival depends on a vertex, the one before it and its place in the walk alone. So it is a
// factor of the densities P> and P< of the next vertex, which all weights are made of: a strategy
// that needs a long walk is known to be seldom.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt {

/// Longest path [edges]. Few walks come so far: of a million with albedo 0.99, 34.
constexpr int kMaxDepth = 1024;

/// Whether walks go on at their vertex i, whatever it is: y_0, y_1, z_0, z_1.
constexpr bool always_goes_on(int i) {
  return i <= 1;
}

}  // namespace tdpt
