// All code of the renderer's kernels, for a kernel and for its scalar build
// (testing/scalar_build.cpp of the renderer).
//
// Include in a scope that has load_name() of SCENE_TABLES and PATH_TABLES [path/tables.h], the
// arrays of the latter, film_words[], the scene's features (see path_bindings.glsl), `render`,
// `guiding`, `light_settings`, `work` and tally_bucket(): a GLSL file after its buffers, or the
// body of a C++ struct. Each included text begins with language.h.

#include "shaders/shared/path/tables.h"

#include "shaders/shared/path/surface.h"

#include "shaders/shared/traversal.h"

#include "shaders/shared/path/lighting.h"

#include "shaders/shared/path/portals.h"

#include "shaders/shared/path/guide.h"

#include "shaders/shared/path/film_sum.h"

#include "shaders/shared/path/film.h"

#include "shaders/shared/path/rays.h"

#include "shaders/shared/path/weight.h"

#include "shaders/shared/path/walk.h"

#include "shaders/shared/path/connection_estimates.h"

#include "shaders/shared/path/connect.h"

#include "shaders/shared/path/segments.h"
