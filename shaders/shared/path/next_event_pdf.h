// Where a next event looks: which light, and where on it, for a given shaded point.
//
// A kind of light is chosen as for light walks, and a light and a place on it. Of the sky a
// direction is drawn through the windows [window_sky.h] with probability q where the point sees
// any, and else from all of it:
//   p_nee(w | x) = P_sky ((1-q) p_sky(w) + q p_windows(w | x)).
// Where rectangular lights are the only surfaces that emit, which of them and where on it depends
// on the point, too [rect_lights.h]. q is less than 1, so that nothing that shines is missed: what
// windows miss, since no portal is there, has 1-q.
//
// Read behind rect_lights.h and window_sky.h.

#include "shaders/shared/language.h"

/// Density of sample_next_event, where `p` has looked out: of the place of `position` on `triangle`
/// of a surface, or in the sky, per measure as LightPlace has it.
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
