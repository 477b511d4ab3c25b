// Headers that kernels.h needs before it.
#ifndef TDPT_SHADERS_SHARED_PATH_KERNEL_HEADS_H
#define TDPT_SHADERS_SHARED_PATH_KERNEL_HEADS_H

#include "shaders/shared/path/connection_estimates.h"
#include "shaders/shared/path/film_units.h"
#include "shaders/shared/path/purposes.h"
#include "shaders/shared/path/surface_heads.h"
#include "shaders/shared/path/tables.h"
#include "shaders/shared/scaled.h"
#include "shaders/shared/sequence.h"
#include "shaders/shared/triangle.h"

#endif
