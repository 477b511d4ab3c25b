// Maximum numbers of connections per sample.
#ifndef TDPT_SHADERS_SHARED_PATH_CONNECTIONS_H
#define TDPT_SHADERS_SHARED_PATH_CONNECTIONS_H

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Light vertices considered for one camera vertex; few of them are connected.
const uint kCandidates = 8u;
const float kPerCandidate = 1.25e-1f;
/// For z_{t-1}. Fewer for later vertices, since earlier ones have already shown most of the light.
/// Measured without a depth limit: 1 for all costs 10 to 15 % of the efficiency, 2 for all costs 5
/// to 15 % with guided walks.
SHARED uint connections_of(uint t) {
  return t > 3u ? 1u : 2u;
}
/// Connections of a segment's x_l with light vertices, besides light that begins there.
const uint kLightSides = 2u;
/// Connections of a sample's camera vertices with segments.
const uint kPairs = 3u;

SHARED_END

#include "shaders/shared/language_end.h"

#endif
