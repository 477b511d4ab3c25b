// What a ray meets.
#ifndef TDPT_SHADERS_SHARED_BVH_H
#define TDPT_SHADERS_SHARED_BVH_H
#include "shaders/shared/language.h"
SHARED_BEGIN
struct SurfaceHit {
  float t;
  uint triangle;
  float b1;
  float b2;
  uint back;
};
SHARED_END
#endif
