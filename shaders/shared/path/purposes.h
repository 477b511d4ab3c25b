// Purposes of a sample's random numbers: each has its own stream [streams.h of libcommon/math].
#ifndef TDPT_SHADERS_SHARED_PATH_PURPOSES_H
#define TDPT_SHADERS_SHARED_PATH_PURPOSES_H

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint PURPOSE_FILM = 0u;  ///< the position within the pixel
const uint PURPOSE_CAMERA_WALK = 1u;
const uint PURPOSE_LIGHT_WALK = 2u;
const uint PURPOSE_NEXT_EVENT = 3u;
const uint PURPOSE_SEGMENT = 4u;  ///< a segment's place on a portal
const uint PURPOSE_CHOICES = 5u;  ///< of vertices to connect

SHARED_END

#include "shaders/shared/language_end.h"

#endif
