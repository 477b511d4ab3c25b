// Russian roulette: ends walks whose length is not fixed.
//
// Method: a walk survives a vertex with probability equal to the albedo there, so that its
// throughput neither fades nor grows; the mean number of bounces in a closed room of albedo a is
// 1/(1-a). It always survives the first vertex: z_1, since a dark pixel is as dark as what it sees
// and the error of a picture is relative; y_1 likewise. More or fewer such vertices, and other
// powers of the albedo, change time and variance by the same factor: error x work is flat.
//
// Survival depends only on a vertex, the one before it and its place in the walk. So it is a factor
// of the densities P> and P< of the next vertex, from which all MIS weights are made: they know
// that a strategy which needs a long walk is rare.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt {

/// Longest path [edges]. Few walks get so far: of a million with albedo 0.99, 34.
constexpr int kMaxDepth = 1024;

/// Whether walks always survive their vertex i: y_0, y_1, z_0, z_1.
constexpr bool always_goes_on(int i) {
  return i <= 1;
}

}  // namespace tdpt
