// The density of next-event estimation, and its sampling with a few large rectangular lights
// (windows, ceiling panels, the face of a lamp): the light and the point on it are chosen by the
// light that arrives at the shaded point, without visibility.
//
// Method: each rectangle is parametrised by
//   a = c(s/H),  b = c(t/H),  c(v) = v / (1 + |v|) in (-1, 1),
// with s, t from the foot of the perpendicular from the point to its plane. This is about as
// uniform as solid angle and needs no arc tangent (window_sky.h does the same for the sky). The
// rest of the geometry term, R, is evaluated at the four corners and interpolated bilinearly over
// (a, b).
//
// Y      mean luminance that a rectangular light emits (a proportional value is enough)
// h, H   height of the point over the plane; the same, but at least a share of the light's size
// z      height of a corner over the horizon of the shading normal, 0 below it; on either side of
//        the surface if light passes through it
// R      z h / d^4 per da db: cos cos / d^2 up to a factor common to the rectangular light
//   p_A(x_0 | x_1) = Y R(a,b) (da db / dA) / sum over the rectangular lights of Y integral R da db
//
// R is an estimate of cos cos / d^2, not a bound: it is 0 only where that is 0. Samples in exact
// proportion (Peters 2021) have 0.93 of its relMSE, and a picture takes twice the time: measured
// with next events alone in two furnished rooms.
//
// If a point is close to a light's plane, the whole light may be between a = 1 - 1e-5 and 1.
// Lengths in a are therefore computed as H (s1 - s0) / (f0 f1), f = H + |s|, and places relative to
// s0, so that no precision is lost.
//
// Include after window_sky.h, in a scope that has what that needs, load_rect_light() and
// scene_has_rect_lights. C++ also has RectLight, Point, LightContext and LightPlace in doubles.

#include "shaders/shared/language.h"

/// A rectangular light as seen from a point.
struct RectLightView {
  REAL height;  ///< H
  REAL s;       ///< of its first corner
  REAL t;
  REAL w00;  ///< R at the corners (0,0), (1,0), (0,1), (1,1)
  REAL w10;
  REAL w01;
  REAL w11;
  REAL total;  ///< integral of R; 0: the other members are not set
};

/// Length in a (or b) of a side that begins at s and is `length` long.
SHARED REAL compressed_length(REAL s, REAL length, REAL H) MEMBER_CONST {
  REAL end = s + length;
  REAL per_f0 = reciprocal(H + abs(s));
  REAL per_f1 = reciprocal(H + abs(end));
  if (s < 0.0f && end > 0.0f) return abs(s) * per_f0 + end * per_f1;
  return H * length * per_f0 * per_f1;
}
/// Inverse: distance from s at which a has covered `share` of that length.
SHARED REAL stretched_part(REAL s, REAL length, REAL H, REAL share) MEMBER_CONST {
  REAL end = s + length;
  REAL f0 = H + abs(s);
  REAL f1 = H + abs(end);
  REAL x;
  if (s < 0.0f && end > 0.0f) {
    REAL before = abs(s) * reciprocal(f0);
    REAL a = share * (before + end * reciprocal(f1)) - before;
    x = H * a * reciprocal(max(1.0f - abs(a), 1e-7f)) - s;
  } else {
    REAL part = share * length;
    x = part * f0 * reciprocal(s >= 0.0f ? f1 - part : f1 + part);
  }
  return min(max(x, 0.0f), length);
}
/// The share of that length at distance x from s.
SHARED REAL compressed_share(REAL s, REAL length, REAL H, REAL x) MEMBER_CONST {
  REAL end = s + length;
  REAL f0 = H + abs(s);
  REAL f1 = H + abs(end);
  REAL share;
  if (s < 0.0f && end > 0.0f) {
    REAL before = abs(s) * reciprocal(f0);
    REAL at = s + x;
    share = (at * reciprocal(H + abs(at)) + before) * reciprocal(before + end * reciprocal(f1));
  } else {
    share = x * f1 * reciprocal(length * (s >= 0.0f ? f0 + x : f0 - x));
  }
  return min(max(share, 0.0f), 1.0f);
}

/// The shading normal, if any, on the side of the path's edges.
SHARED VEC3 rect_light_horizon(IN(Point) p, VEC3 facing) MEMBER_CONST {
  if (p.simple) return facing;
  return dot(p.shading, facing) < 0.0f ? -p.shading : p.shading;
}

/// R of a corner at (s, t) that is `over` above the horizon.
SHARED REAL corner_weight(REAL over, REAL s, REAL t, REAL H, REAL height, REAL scale) MEMBER_CONST {
  // Distances to a corner are clamped here.
  REAL h = max(height, 1e-3f * H);
  REAL spread_per_d2 = (H + abs(s)) * (H + abs(t)) * reciprocal(s * s + t * t + h * h);
  return over * scale * (spread_per_d2 * spread_per_d2);
}

SHARED RectLightView no_view() MEMBER_CONST {
  RectLightView view = {1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  return view;
}

/// Evaluates a rectangular light from `position`; `up`: normal of its horizon; `both_ways`: light
/// passes through the surface.
SHARED RectLightView look_at_rect_light(IN(RectLight) rect_light, VEC3 position, VEC3 up,
                                        bool both_ways) MEMBER_CONST {
  RectLightView view = no_view();
  VEC3 r = rect_light.corner - position;
  REAL front = -dot(rect_light.normal, r);
  REAL height = is_two_sided(rect_light.source) ? abs(front) : front;
  if (!(height > 1e-30f)) return view;
  REAL z = dot(up, r);
  REAL z_x = dot(up, rect_light.x) * rect_light.length_x;
  REAL z_y = dot(up, rect_light.y) * rect_light.length_y;
  VEC3 z3 = VEC3(z + z_x, z + z_y, z + z_x + z_y);
  REAL o00 = both_ways ? abs(z) : max(z, 0.0f);
  REAL o10 = both_ways ? abs(z3.x) : max(z3.x, 0.0f);
  REAL o01 = both_ways ? abs(z3.y) : max(z3.y, 0.0f);
  REAL o11 = both_ways ? abs(z3.z) : max(z3.z, 0.0f);
  if (!(max(max(o00, o10), max(o01, o11)) > 0.0f)) return view;
  REAL H = max(height, rect_light.least_height);
  REAL per_H = reciprocal(H);
  REAL scale = height * per_H * per_H;
  REAL s = dot(rect_light.x, r);
  REAL t = dot(rect_light.y, r);
  REAL s1 = s + rect_light.length_x;
  REAL t1 = t + rect_light.length_y;
  view.height = H;
  view.s = s;
  view.t = t;
  view.w00 = corner_weight(o00, s, t, H, height, scale);
  view.w10 = corner_weight(o10, s1, t, H, height, scale);
  view.w01 = corner_weight(o01, s, t1, H, height, scale);
  view.w11 = corner_weight(o11, s1, t1, H, height, scale);
  REAL mean = 0.25f * (view.w00 + view.w10 + view.w01 + view.w11);
  REAL total = mean * compressed_length(s, rect_light.length_x, H) *
               compressed_length(t, rect_light.length_y, H);
  view.total = total > 1e-30f ? total : 0.0f;
  return view;
}

/// Estimated light from all rectangular lights at a point.
SHARED REAL sent_by_rect_lights(IN(Point) p, VEC3 facing) MEMBER_CONST {
  VEC3 up = rect_light_horizon(p, facing);
  REAL sum = 0.0f;
  for (uint i = 0u; i < light_settings.rect_lights; ++i)
    sum += load_rect_light(i).weight *
           look_at_rect_light(load_rect_light(i), p.position, up, is_zero(facing)).total;
  return sum;
}

/// p_A at (x, y) along the sides of a rectangular light; `sent`: by all.
SHARED REAL rect_light_pdf_A(IN(RectLight) rect_light, IN(RectLightView) view, REAL x, REAL y,
                             REAL sent) MEMBER_CONST {
  if (!(view.total > 0.0f) || !(sent > 0.0f)) return 0.0f;
  REAL H = view.height;
  REAL U = compressed_share(view.s, rect_light.length_x, H, x);
  REAL V = compressed_share(view.t, rect_light.length_y, H, y);
  REAL per_f = H * reciprocal((H + abs(view.s + x)) * (H + abs(view.t + y)));
  return rect_light.weight * between_corners(view.w00, view.w10, view.w01, view.w11, U, V) * per_f *
         per_f * reciprocal(sent);
}
/// The same for a position.
SHARED REAL rect_light_pdf_A_at(IN(RectLight) rect_light, IN(RectLightView) view, VEC3 position,
                                REAL sent) MEMBER_CONST {
  VEC3 from_corner = position - rect_light.corner;
  REAL x = min(max(dot(rect_light.x, from_corner), 0.0f), rect_light.length_x);
  REAL y = min(max(dot(rect_light.y, from_corner), 0.0f), rect_light.length_y);
  return rect_light_pdf_A(rect_light, view, x, y, sent);
}

/// Index of the rectangular light that contains `triangle`; their number if none does.
SHARED uint rect_light_of(uint triangle) MEMBER_CONST {
  uint found = light_settings.rect_lights;
  for (uint i = 0u; i < light_settings.rect_lights; ++i)
    found = load_rect_light(i).triangle0 == triangle || load_rect_light(i).triangle1 == triangle
                ? i
                : found;
  return found;
}

/// p_A of a point on any rectangular light; 0 if `triangle` belongs to none.
SHARED REAL pdf_A_by_rect_lights(IN(Point) p, IN(LightContext) light_context, uint triangle,
                                 VEC3 position) MEMBER_CONST {
  uint i = rect_light_of(triangle);
  if (i == light_settings.rect_lights) return 0.0f;
  VEC3 up = rect_light_horizon(p, light_context.facing);
  RectLightView view =
      look_at_rect_light(load_rect_light(i), p.position, up, is_zero(light_context.facing));
  return rect_light_pdf_A_at(load_rect_light(i), view, position, light_context.sent);
}

/// Barycentric of a rectangular light's corner k, counted around, at x and y in [0,1] of its sides,
/// on the corner's half of the diagonal.
SHARED REAL rect_light_corner_share(uint k, REAL x, REAL y) MEMBER_CONST {
  return k == 0u ? 1.0f - max(x, y) : k == 1u ? x - y : k == 2u ? min(x, y) : y - x;
}

/// Samples a point on a rectangular light with its p_A, from two numbers in [0,1).
SHARED LightPlace place_on_rect_light(IN(RectLight) rect_light, IN(RectLightView) seen, REAL sent,
                                      REAL u, REAL v) MEMBER_CONST {
  LightPlace place = no_light_place();
  REAL V = drawn_linear(seen.w00 + seen.w10, seen.w01 + seen.w11, v);
  REAL U =
      drawn_linear(seen.w00 * (1.0f - V) + seen.w01 * V, seen.w10 * (1.0f - V) + seen.w11 * V, u);
  REAL x = stretched_part(seen.s, rect_light.length_x, seen.height, U);
  REAL y = stretched_part(seen.t, rect_light.length_y, seen.height, V);
  place.position = rect_light.corner + rect_light.x * x + rect_light.y * y;
  place.source = rect_light.source;
  REAL x_share = x * reciprocal(rect_light.length_x);
  REAL y_share = y * reciprocal(rect_light.length_y);
  bool first = x_share >= y_share;
  place.triangle = first ? rect_light.triangle0 : rect_light.triangle1;
  uint corners = first ? rect_light.corners : rect_light.corners >> 4;
  place.b1 = rect_light_corner_share(corners & 3u, x_share, y_share);
  place.b2 = rect_light_corner_share(corners >> 2 & 3u, x_share, y_share);
  place.pdf = rect_light_pdf_A_at(rect_light, seen, place.position, sent);
  return place;
}

/// Samples a point on any of them; SOURCE_NONE if none sends anything. Three numbers in [0,1).
SHARED LightPlace place_on_rect_lights(IN(Point) p, IN(LightContext) light_context, REAL pick,
                                       REAL u, REAL v) MEMBER_CONST {
  if (!(light_context.sent > 0.0f)) return no_light_place();
  VEC3 up = rect_light_horizon(p, light_context.facing);
  bool both_ways = is_zero(light_context.facing);
  REAL left = pick * light_context.sent;
  uint chosen = 0u;
  RectLightView seen = no_view();
  for (uint i = 0u; i < light_settings.rect_lights && left >= 0.0f; ++i) {
    RectLightView view = look_at_rect_light(load_rect_light(i), p.position, up, both_ways);
    REAL share = load_rect_light(i).weight * view.total;
    if (!(share > 0.0f)) continue;
    chosen = i;
    seen = view;
    left = left < share ? -1.0f : left - share;
  }
  if (!(seen.total > 0.0f)) return no_light_place();
  return place_on_rect_light(load_rect_light(chosen), seen, light_context.sent, u, v);
}

// Density of next-event estimation at a shaded point: which light, and which point on it.
//
// A kind of light, a light and a point on it are chosen as for light walks, with two exceptions. If
// the point sees windows [window_sky.h], a direction of the sky is drawn through them with
// probability q, otherwise from the whole sky:
//   p_nee(w | x) = P_sky ((1-q) p_sky(w) + q p_windows(w | x)).
// If rectangular lights are the only emitting surfaces, the choice of the light and of the point on
// it depends on x, too. q is below 1, so that no light is missed: what windows do
// not cover, since no portal is there, keeps 1-q.

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
