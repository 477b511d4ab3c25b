// How many connections a sample makes, at most.
#ifndef TDPT_SHADERS_SHARED_PATH_CONNECTIONS_H
#define TDPT_SHADERS_SHARED_PATH_CONNECTIONS_H

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Light vertices that are looked at for one camera vertex; few of them are connected.
const uint kCandidates = 8u;
const float kPerCandidate = 1.25e-1f;
/// Of z_{t-1}: fewer where a walk is long, since most of what the picture shows has been told
/// before. Measured without limit: 1 for all costs 10 to 15 % of the efficiency, 2 for all 5 to 15
/// % with directed walks.
SHARED uint connections_of(uint t) {
  return t > 3u ? 1u : 2u;
}
/// Of a portal segment's x_l with light vertices, beside light that begins there.
const uint kLightSides = 2u;
/// Of a sample's camera vertices with segments.
const uint kPairs = 3u;

SHARED_END

#include "shaders/shared/language_end.h"

#endif
