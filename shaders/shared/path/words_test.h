// Test only: what lights_test.h, portals_test.h and surface_test.h read and write.
#ifndef TDPT_SHADERS_SHARED_PATH_WORDS_TEST_H
#define TDPT_SHADERS_SHARED_PATH_WORDS_TEST_H

#include "shaders/shared/path/lights_layout.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/vector.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kLightWords = 64u;
const uint kShadedPlaces = 16u;

struct LightWords {
  uint count;
  uint words[64];
};

struct Shaded {
  vec3 position;
  uint simple;
  vec3 normal;
  float through_windows;
  vec3 shading;
  uint pad0;
  vec3 facing;
  uint pad1;
};

/// What a scene has, as bits.
const uint HAS_SKY = 1u;
const uint HAS_SKY_MAP = 2u;
const uint HAS_LAMPS = 4u;
const uint HAS_RECT_LIGHTS = 8u;
const uint HAS_WINDOWS = 16u;
const uint PREFERS = 32u;

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

const uint kWordsOfPlace = 64u;

struct PlaceWords {
  uint words[64];
  uint count;
};

SHARED_END

#include "shaders/shared/language_end.h"

#endif
