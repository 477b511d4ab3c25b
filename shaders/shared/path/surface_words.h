// Test only: the output of surface_test.h.
#ifndef TDPT_SHADERS_SHARED_PATH_SURFACE_WORDS_H
#define TDPT_SHADERS_SHARED_PATH_SURFACE_WORDS_H

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kWordsOfPlace = 64u;

struct PlaceWords {
  uint words[64];
  uint count;
};

SHARED_END

#include "shaders/shared/language_end.h"

#endif
