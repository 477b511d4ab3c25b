// Headers that surface.h needs before it.
#ifndef TDPT_SHADERS_SHARED_PATH_SURFACE_HEADS_H
#define TDPT_SHADERS_SHARED_PATH_SURFACE_HEADS_H

#include "shaders/shared/elementary.h"
#include "shaders/shared/path/fresnel.h"
#include "shaders/shared/path/ggx.h"
#include "shaders/shared/path/point.h"
#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/path/surface_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/texels.h"
#include "shaders/shared/warp.h"

#endif
