// Density of next-event estimation at a shaded point: which light, and which point on it.
//
// A kind of light, a light and a point on it are chosen as for light walks, with two exceptions. If
// the point sees windows [window_sky.h], a direction of the sky is drawn through them with
// probability q, otherwise from the whole sky:
//   p_nee(w | x) = P_sky ((1-q) p_sky(w) + q p_windows(w | x)).
// If rectangular lights are the only emitting surfaces, the choice of the light and of the point on
// it depends on x, too [rect_lights.h]. q is below 1, so that no light is missed: what windows do
// not cover, since no portal is there, keeps 1-q.
//
// Include after rect_lights.h and window_sky.h.

#include "shaders/shared/language.h"

/// Density of sample_next_event for `p`, after look_out(): of `position` on `triangle` of a
/// surface, or in the sky, per measure as in LightPlace.
SHARED REAL next_event_pdf(IN(Point) p, IN(LightContext) light_context, REAL through_windows,
                           Source source, uint triangle, VEC3 position,
                           IN(InSky) in_sky) MEMBER_CONST {
  if (scene_has_rect_lights && is_surface(source))
    return light_settings.surfaces * pdf_A_by_rect_lights(p, light_context, triangle, position);
  if (!is_sky(source)) return light_pdf(source, triangle, position, in_sky);
  REAL pdf_w = in_sky.plain_w;
  if (scene_has_windows && light_context.seen > 0.0f && through_windows > 0.0f)
    pdf_w = (1.0f - through_windows) * pdf_w +
            through_windows *
                windows_pdf_w(p.position, light_context.facing, light_context.seen, -position);
  return light_settings.sky_pdf_1 * pdf_w;
}

#include "shaders/shared/language_end.h"
