// Next events at the few big flat emitters that rooms have: tools/tdpt-render/path/light/panels.h
// in floats, where the method is told.
//
// Read behind lights.h, within a scope that has what that needs, load_light_panel() and
// scene_has_panels.
//
// Where a point lies close to a panel's plane, all of the panel may be between a = 1 - 1e-5 and 1:
// lengths in a are taken as H (s1 - s0) / (f0 f1), f = H + |s|, and places from s0 on, so that
// nothing is lost.

#include "shaders/shared/language.h"

/// Length in a (b) of a side from s on that is `length` long.
SHARED float compressed_length(float s, float length, float H) MEMBER_CONST {
  float end = s + length;
  float per_f0 = reciprocal(H + abs(s));
  float per_f1 = reciprocal(H + abs(end));
  if (s < 0.0f && end > 0.0f) return abs(s) * per_f0 + end * per_f1;
  return H * length * per_f0 * per_f1;
}
/// Place on the side where a has grown by `share` of that length, from s on.
SHARED float stretched_part(float s, float length, float H, float share) MEMBER_CONST {
  float end = s + length;
  float f0 = H + abs(s);
  float f1 = H + abs(end);
  float x;
  if (s < 0.0f && end > 0.0f) {
    float before = abs(s) * reciprocal(f0);
    float a = share * (before + end * reciprocal(f1)) - before;
    x = H * a * reciprocal(max(1.0f - abs(a), 1e-7f)) - s;
  } else {
    float part = share * length;
    x = part * f0 * reciprocal(s >= 0.0f ? f1 - part : f1 + part);
  }
  return min(max(x, 0.0f), length);
}
/// And the other way round.
SHARED float compressed_share(float s, float length, float H, float x) MEMBER_CONST {
  float end = s + length;
  float f0 = H + abs(s);
  float f1 = H + abs(end);
  float share;
  if (s < 0.0f && end > 0.0f) {
    float before = abs(s) * reciprocal(f0);
    float at = s + x;
    share = (at * reciprocal(H + abs(at)) + before) * reciprocal(before + end * reciprocal(f1));
  } else {
    share = x * f1 * reciprocal(length * (s >= 0.0f ? f0 + x : f0 - x));
  }
  return min(max(share, 0.0f), 1.0f);
}

/// On the side of the shading normal that the edges of the path are on, if there is one.
SHARED vec3 panel_horizon(Point p, vec3 facing) MEMBER_CONST {
  if (p.simple) return facing;
  return dot(p.shading, facing) < 0.0f ? -p.shading : p.shading;
}

/// Weight of a corner at (s, t), `over` the horizon.
SHARED float corner_weight(float over, float s, float t, float H, float height,
                           float scale) MEMBER_CONST {
  // Nearer than that to a corner is no nearer.
  float h = max(height, 1e-3f * H);
  float spread_per_d2 = (H + abs(s)) * (H + abs(t)) * reciprocal(s * s + t * t + h * h);
  return over * scale * (spread_per_d2 * spread_per_d2);
}

SHARED PanelView no_view() MEMBER_CONST {
  PanelView view;
  view.height = 1.0f;
  view.s = 0.0f;
  view.t = 0.0f;
  view.w00 = 0.0f;
  view.w10 = 0.0f;
  view.w01 = 0.0f;
  view.w11 = 0.0f;
  view.total = 0.0f;
  return view;
}

/// A panel from `position`; `up`: of its horizon, `both_ways`: light goes through the surface.
SHARED PanelView look_at_panel(Panel panel, vec3 position, vec3 up, bool both_ways) MEMBER_CONST {
  PanelView view = no_view();
  vec3 r = panel.corner - position;
  float front = -dot(panel.normal, r);
  float height = panel.source == SOURCE_BOTH ? abs(front) : front;
  if (!(height > 1e-30f)) return view;
  float z = dot(up, r);
  float z_x = dot(up, panel.x) * panel.length_x;
  float z_y = dot(up, panel.y) * panel.length_y;
  vec3 z3 = vec3(z + z_x, z + z_y, z + z_x + z_y);
  float o00 = both_ways ? abs(z) : max(z, 0.0f);
  float o10 = both_ways ? abs(z3.x) : max(z3.x, 0.0f);
  float o01 = both_ways ? abs(z3.y) : max(z3.y, 0.0f);
  float o11 = both_ways ? abs(z3.z) : max(z3.z, 0.0f);
  float H = max(height, panel.least_height);
  float per_H = reciprocal(H);
  float scale = height * per_H * per_H;
  float s = dot(panel.x, r);
  float t = dot(panel.y, r);
  float s1 = s + panel.length_x;
  float t1 = t + panel.length_y;
  view.height = H;
  view.s = s;
  view.t = t;
  view.w00 = corner_weight(o00, s, t, H, height, scale);
  view.w10 = corner_weight(o10, s1, t, H, height, scale);
  view.w01 = corner_weight(o01, s, t1, H, height, scale);
  view.w11 = corner_weight(o11, s1, t1, H, height, scale);
  float mean = 0.25f * (view.w00 + view.w10 + view.w01 + view.w11);
  float total =
      mean * compressed_length(s, panel.length_x, H) * compressed_length(t, panel.length_y, H);
  view.total = total > 1e-30f ? total : 0.0f;
  return view;
}

/// What all panels send to a point.
SHARED float sent_by_panels(Point p, vec3 facing) MEMBER_CONST {
  vec3 up = panel_horizon(p, facing);
  float sum = 0.0f;
  for (uint i = 0u; i < light_settings.panels; ++i)
    sum += load_light_panel(i).weight *
           look_at_panel(load_light_panel(i), p.position, up, is_zero(facing)).total;
  return sum;
}

/// p_A of a place x along, y across a panel, with `sent` by all.
SHARED float panel_pdf_A(Panel panel, PanelView view, float x, float y, float sent) MEMBER_CONST {
  if (!(view.total > 0.0f) || !(sent > 0.0f)) return 0.0f;
  float H = view.height;
  float U = compressed_share(view.s, panel.length_x, H, x);
  float V = compressed_share(view.t, panel.length_y, H, y);
  float per_f = H * reciprocal((H + abs(view.s + x)) * (H + abs(view.t + y)));
  return panel.weight * between_corners(view.w00, view.w10, view.w01, view.w11, U, V) * per_f *
         per_f * reciprocal(sent);
}
/// The same of a place that is told by its position.
SHARED float panel_pdf_A_at(Panel panel, PanelView view, vec3 position, float sent) MEMBER_CONST {
  vec3 from_corner = position - panel.corner;
  float x = min(max(dot(panel.x, from_corner), 0.0f), panel.length_x);
  float y = min(max(dot(panel.y, from_corner), 0.0f), panel.length_y);
  return panel_pdf_A(panel, view, x, y, sent);
}

/// The panel that has `triangle`; as many as there are: none has.
SHARED uint panel_of(uint triangle) MEMBER_CONST {
  uint found = light_settings.panels;
  for (uint i = 0u; i < light_settings.panels; ++i)
    found = load_light_panel(i).triangle0 == triangle || load_light_panel(i).triangle1 == triangle
                ? i
                : found;
  return found;
}

/// p_A of a place on a panel, which is 0 on what is none.
SHARED float pdf_A_by_panels(Point p, Outlook outlook, uint triangle, vec3 position) MEMBER_CONST {
  uint i = panel_of(triangle);
  if (i == light_settings.panels) return 0.0f;
  vec3 up = panel_horizon(p, outlook.facing);
  PanelView view = look_at_panel(load_light_panel(i), p.position, up, is_zero(outlook.facing));
  return panel_pdf_A_at(load_light_panel(i), view, position, outlook.sent);
}

/// Of a panel's corner k, counted around, at x and y in [0,1] of its sides, on the half of the
/// diagonal that the corner is on.
SHARED float panel_corner_share(uint k, float x, float y) MEMBER_CONST {
  return k == 0u ? 1.0f - max(x, y) : k == 1u ? x - y : k == 2u ? min(x, y) : y - x;
}

/// A place on a panel with p_A; none where none sends anything. Three numbers in [0,1).
SHARED LightPlace place_on_panels(Point p, Outlook outlook, float pick, float u,
                                  float v) MEMBER_CONST {
  LightPlace place = no_light_place();
  if (!(outlook.sent > 0.0f)) return place;
  vec3 up = panel_horizon(p, outlook.facing);
  bool both_ways = is_zero(outlook.facing);
  float left = pick * outlook.sent;
  uint chosen = 0u;
  PanelView seen = no_view();
  for (uint i = 0u; i < light_settings.panels && left >= 0.0f; ++i) {
    PanelView view = look_at_panel(load_light_panel(i), p.position, up, both_ways);
    float share = load_light_panel(i).weight * view.total;
    if (!(share > 0.0f)) continue;
    chosen = i;
    seen = view;
    left = left < share ? -1.0f : left - share;
  }
  if (!(seen.total > 0.0f)) return place;
  Panel panel = load_light_panel(chosen);
  float V = drawn_linear(seen.w00 + seen.w10, seen.w01 + seen.w11, v);
  float U =
      drawn_linear(seen.w00 * (1.0f - V) + seen.w01 * V, seen.w10 * (1.0f - V) + seen.w11 * V, u);
  float x = stretched_part(seen.s, panel.length_x, seen.height, U);
  float y = stretched_part(seen.t, panel.length_y, seen.height, V);
  place.position = panel.corner + panel.x * x + panel.y * y;
  place.source = panel.source;
  float x_share = x * reciprocal(panel.length_x);
  float y_share = y * reciprocal(panel.length_y);
  bool first = x_share >= y_share;
  place.triangle = first ? panel.triangle0 : panel.triangle1;
  uint corners = first ? panel.corners : panel.corners >> 4;
  place.b1 = panel_corner_share(corners & 3u, x_share, y_share);
  place.b2 = panel_corner_share(corners >> 2 & 3u, x_share, y_share);
  place.pdf = panel_pdf_A_at(panel, seen, place.position, outlook.sent);
  return place;
}

#include "shaders/shared/language_end.h"
