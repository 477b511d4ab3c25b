// Test only: the words of portals_test.h, one trial per invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/path/words_test.h"
#include "shaders/shared/tables.h"
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Facets { PortalFacet portal_facets[]; };
layout(std430, binding = 1) readonly buffer Polygons { PortalPolygon portal_polygons[]; };
layout(std430, binding = 2) readonly buffer Corners { PortalCorner portal_corners[]; };
layout(std430, binding = 3) readonly buffer Pairs { PortalPair portal_pairs[]; };
layout(std430, binding = 4) readonly buffer Guiding { GuideParameters guiding; };
layout(std430, binding = 5) writeonly buffer Words { uint words[]; };
layout(push_constant) uniform Parameters { TrialParameters render; };
const bool scene_has_portals = true;
const bool portals_have_pairs = true;
#ifdef UNGUIDED
const bool guide_active = false;
#else
const bool guide_active = true;
#endif
TABLES_OF_PORTALS(LOADS)
#include "shaders/shared/path/portals.h"

#include "shaders/shared/path/portals_test.h"

void main() {
  PortalTrial trial = try_portals(gl_GlobalInvocationID.x);
  for (uint k = 0u; k < kTrialWords; ++k)
    words[gl_GlobalInvocationID.x * kTrialWords + k] = trial.words[k];
}
