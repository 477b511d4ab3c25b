// Test only: records of portals_test.h.
#ifndef TDPT_SHADERS_SHARED_PATH_PORTALS_TEST_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_PORTALS_TEST_LAYOUT_H

#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Of guide.h.
struct TrialParameters {
  float guide_light;
  float guide_camera;
};

const uint kTrialWords = 38u;

struct PortalTrial {
  uint words[38];
  uint told;
};

SHARED_END

#include "shaders/shared/language_end.h"

#endif
