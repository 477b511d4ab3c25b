// All code on lights, for kernels and their scalar build, including the sampling of next events.
//
// Include in a scope that has load_name() of TABLES_OF_LIGHTS [tables.h], light_settings,
// scene_has_sky, scene_has_sky_map, scene_has_lamps, scene_has_rect_lights, scene_has_windows and
// scene_prefers: a GLSL file after its buffers, or the body of a C++ struct.

#include "shaders/shared/path/lights_layout.h"

#include "shaders/shared/path/sky.h"

#include "shaders/shared/path/lamp.h"

#include "shaders/shared/path/lights.h"

#include "shaders/shared/path/rect_lights.h"

#include "shaders/shared/path/window_sky.h"

#include "shaders/shared/path/next_event_pdf.h"

#include "shaders/shared/path/next_event.h"
