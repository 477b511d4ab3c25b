// All code on lights, for kernels and their scalar build, including the sampling of next events.
//
// Include in a scope that has load_name() of TABLES_OF_LIGHTS [records.h], light_settings,
// scene_has_sky, scene_has_sky_map, scene_has_lamps, scene_has_rect_lights, scene_has_windows and
// scene_prefers: a GLSL file after its buffers, or the body of a C++ struct.

#include "shaders/shared/path/lights_layout.h"

#include "shaders/shared/path/sky.h"

#include "shaders/shared/path/lamp.h"

#include "shaders/shared/path/lights.h"

#include "shaders/shared/path/window_sky.h"

#include "shaders/shared/path/next_event.h"

#include "shaders/shared/language.h"

/// Evaluates windows and rectangular lights from `p`; light arrives on the side `facing` (0: both).
SHARED void look_out(Point p, vec3 facing, OUT(LightContext) o) MEMBER_CONST {
  o.facing = facing;
  o.seen = 0.0f;
  o.sent = 0.0f;
  if (!p.connectible) return;
  if (scene_has_windows) o.seen = seen_through_windows(p.position, facing);
  if (scene_has_rect_lights) o.sent = sent_by_rect_lights(p, facing);
}

/// Samples a point on a light for `p`, after look_out(). SOURCE_NONE if no rectangular light sends
/// anything. `through_windows`: the share of the sky's samples drawn through windows, if `p` sees
/// any. A direction below the horizon gets density 0. Four numbers in [0,1), as in sample_light.
SHARED LightPlace sample_next_event(Point p, INOUT(LightContext) light_context,
                                    float through_windows, float pick, float u, float v,
                                    float side) MEMBER_CONST {
  LightPlace place = no_light_place();
  if (light_settings.entries == 0u) return place;
  uint word = pick_word(pick, side);
  uint entry = drawn_light(word);
  if (scene_has_rect_lights && entry < light_settings.emitters) {
    place = place_on_rect_lights(p, light_context, float(word) * light_settings.per_surfaces, u, v);
    place.pdf = place.pdf * light_settings.surfaces;
    return place;
  }
  if (!is_sky_entry(entry)) return place_on_light(entry, u, v, side);
  if (scene_has_sky) {
    place.source = SOURCE_SKY;
    bool through = scene_has_windows && light_context.seen > 0.0f && side < through_windows;
    SkyPlace drawn;
    if (through)
      drawn = any_place(towards_window(p.position, light_context.facing, light_context.seen,
                                       side * reciprocal(through_windows), u, v));
    else
      drawn = drawn_in_sky(light_settings.plain, word_in_sky(word, side), u, v);
    place.position = -drawn.towards;
    if (!is_zero(light_context.facing) && !(dot(light_context.facing, drawn.towards) > 0.0f))
      return place;
    place.in_sky = look_in_sky(drawn);
    place.pdf = next_event_pdf(p, light_context, through_windows, SOURCE_SKY, kNoTriangle,
                               place.position, place.in_sky);
  }
  return place;
}

#include "shaders/shared/language_end.h"
