// What a point does with light: simple or in layers, with a coat or without. The text of
// tools/tdpt-render/path/bsdf/scatter.cpp and path/sample/{surface,roulette}.cpp in floats.
//
// Read behind coated.h, within the same scope.

#include "shaders/shared/language.h"

SHARED bool is_layered(Point p) MEMBER_CONST {
  return scene_has_layers && !p.simple;
}

/// Of f and light along l, seen from c: n_c^2 |l.ns| / |l.ng| for the base, |l.ns| / |l.ng| for the
/// coat.
SHARED vec3 of_radiance(Point p, Layers layers, Seen l, Seen c) MEMBER_CONST {
  float n = index_at(p.bsdf, c.base);
  float per_side = reciprocal(max(abs(l.side), 1e-12f));
  return layers.base * (n * n * abs(l.base.z) * per_side) +
         vec3(layers.coat * abs(l.coat.z) * per_side);
}

/// Radiance BSDF without Dirac lobes [1/sr]; unit directions away from the surface.
SHARED vec3 bsdf_at(Point p, vec3 to_light, vec3 to_camera) MEMBER_CONST {
  if (!is_layered(p)) return same_side(p, to_light, to_camera) ? p.color * kInversePi : vec3(0.0f);
  Standing l = standing_at(p, to_light);
  Seen c = seen_from(p, to_camera);
  return of_radiance(p, layers_between(p, l, c, false), l.seen, c);
}

/// n_to^2 |cos_to| of a Dirac lobe, about the normal that it is reflected by.
SHARED float dirac_measure(Point p, Layers layers, Seen to) MEMBER_CONST {
  if (has_coat(p.bsdf) && is_zero(layers.base)) return abs(to.coat.z);
  float n = index_at(p.bsdf, to.base);
  return n * n * abs(to.base.z);
}

/// Probability that a ray along `w`, of any length, finds a pane; 1 of all else.
SHARED float presence_at(uint triangle, vec3 w) MEMBER_CONST {
  if (!scene_has_panes) return 1.0f;
  SurfaceMaterial m = load_material(load_face(triangle).material);
  if (!(m.pane_share > 0.0f)) return 1.0f;
  vec3 unit = normalized(brought_near_1(w));
  FresnelCurve f = schlick_curve(min(abs(dot(load_face(triangle).normal, unit)), 1.0f));
  return 1.0f - m.pane_share * ((1.0f - m.pane_f90) + (m.pane_f90 - m.pane_f0) * f.rest);
}

/// All that the end of a walk, which came to `p` from unit `back`, makes of the way on along unit
/// w. `dirac`: by a Dirac lobe; then f is of no meaning.
SHARED Scattering scattering_at(Point p, uint from, vec3 back, vec3 w, bool dirac) MEMBER_CONST {
  Scattering s;
  s.pad0 = 0.0f;
  s.pad1 = 0.0f;
  s.dirac = 0.0f;
  s.broad = 1.0f;
  s.dirac_behind = 0.0f;
  s.broad_behind = 1.0f;
  if (!is_layered(p)) {
    bool passes = !dirac && same_side(p, back, w);
    s.f = passes ? p.color * kInversePi : vec3(0.0f);
    s.onward_w = passes ? abs(dot(p.normal, w)) * kInversePi : 0.0f;
    s.behind_w = passes ? abs(dot(p.normal, back)) * kInversePi : 0.0f;
    s.albedo = on_surface(p) ? min(max(largest(p.color), 0.05f), 1.0f) : 1.0f;
    return s;
  }
  // Each way in turn: one text of a surface is enough for a kernel.
  for (uint i = 0u; i < 2u; ++i) {
    Standing here = standing_at(p, i == 0u ? back : w);
    Seen to = seen_from(p, i == 0u ? w : back);
    Layers layers = layers_between(p, here, to, dirac);
    Odds odds = coated_odds(p, here);
    float pdf_w = dirac ? layers.pdf_w * dirac_measure(p, layers, to) : layers.pdf_w;
    if (i == 0u) {
      s.onward_w = pdf_w;
      s.dirac = odds.dirac;
      s.broad = odds.broad;
      bool back_is_light = from == FROM_LIGHT;
      Seen l = here.seen;
      Seen c = to;
      if (!back_is_light) {
        l = to;
        c = here.seen;
      }
      s.f = dirac ? vec3(0.0f) : of_radiance(p, layers, l, c);
    } else {
      s.behind_w = pdf_w;
      s.dirac_behind = odds.dirac;
      s.broad_behind = odds.broad;
      s.albedo = largest(coated_albedo(p, here));
    }
  }
  if (scene_has_panes) s.albedo = s.albedo * reciprocal(max(presence_at(p.triangle, w), 1e-6f));
  s.albedo = min(max(s.albedo, 0.05f), 1.0f);
  return s;
}

/// Density of scattering along `to` when the walk came along unit `back`, away from the surface
/// [1/sr]. `dirac`: by a Dirac lobe: its probability times n_to^2 |cos_to|, the density per
/// n^2 |cos| dw, which reflection and refraction preserve.
SHARED float scatter_pdf_w(Point at, vec3 back, vec3 to, bool dirac) MEMBER_CONST {
  if (!is_layered(at)) {
    float cosine = dot(at.normal, to);
    return !dirac && dot(at.normal, back) * cosine > 0.0f ? abs(cosine) * kInversePi : 0.0f;
  }
  Seen next = seen_from(at, to);
  Layers layers = layers_between(at, standing_at(at, back), next, dirac);
  return dirac ? layers.pdf_w * dirac_measure(at, layers, next) : layers.pdf_w;
}

/// f cos / pdf_w of the way from `back` to `to`, or reflectance by probability; false: none leads
/// there.
SHARED bool weigh(Point p, uint from, Standing here, Seen to, bool dirac,
                  OUT(vec3) weight) MEMBER_CONST {
  Layers layers = layers_between(p, here, to, dirac);
  Seen back = here.seen;
  weight = vec3(0.0f);
  if (!(layers.pdf_w > 1e-30f)) return false;
  bool from_camera = from == FROM_CAMERA;
  float over_pdf = reciprocal(layers.pdf_w);
  if (dirac) {
    // f = reflectance n_c^2 |l.ns| / |l.ng| per n^2 |cos| dw.
    bool coat = has_coat(p.bsdf) && is_zero(layers.base);
    float n = index_at(p.bsdf, back.base) * reciprocal(index_at(p.bsdf, to.base));
    float factor = coat ? 1.0f : n * n;
    if (!from_camera)
      factor = abs((coat ? back.coat.z : back.base.z) * to.side) *
               reciprocal(max(abs(back.side * (coat ? to.coat.z : to.base.z)), 1e-30f));
    weight = (layers.base + vec3(layers.coat)) * (factor * over_pdf);
  } else {
    vec3 f = from_camera ? of_radiance(p, layers, to, back) : of_radiance(p, layers, back, to);
    weight = f * (abs(to.side) * over_pdf);
  }
  return true;
}

/// The next direction given: `t` is by a lobe that is not Dirac.
SHARED bool turn_towards(Point p, uint from, vec3 back, vec3 w, OUT(Turn) t) MEMBER_CONST {
  t.w = w;
  t.dirac = false;
  t.weight = p.color;
  if (!is_layered(p)) return same_side(p, back, w);
  return weigh(p, from, standing_at(p, back), seen_from(p, w), false, t.weight);
}

/// The next direction of a walk that came along unit `back`. u, v: direction; `choice`: of a lobe.
/// False when the walk ends here; t.dirac then tells whether a Dirac lobe was tried, as bent
/// normals may send what it reflects into the surface.
SHARED bool turn(Point p, uint from, vec3 back, float u, float v, float choice,
                 OUT(Turn) t) MEMBER_CONST {
  t.dirac = false;
  t.weight = p.color;
  if (!is_layered(p)) {
    vec3 n = dot(p.normal, back) > 0.0f ? p.normal : -p.normal;
    t.w = cosine_hemisphere(n, u, v);
    return true;
  }
  t.w = back;
  vec3 to;
  bool by_coat;
  Standing here = standing_at(p, back);
  if (!coated_turn(p, here, u, v, choice, to, t.dirac, by_coat)) return false;
  t.w = normalized(to_world(onb_about(p.shading), to));
  Seen next = seen_from(p, t.w);
  // Bent normals may send it to a side where the lobe that it comes from is not seen.
  if (!(by_coat ? both_on_coat(here.seen, next) : next.on_base)) return false;
  return weigh(p, from, here, next, t.dirac, t.weight);
}

SHARED Odds odds_at(Point p, vec3 back) MEMBER_CONST {
  Odds odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (!is_layered(p)) return odds;
  return coated_odds(p, standing_at(p, back));
}

/// Albedo of a surface as it is seen along unit `back`: the largest component, but 0.05 at least, 1
/// at most; 1 off surfaces. Of a pane, that of the share of rays that find it.
SHARED float albedo_at(Point p, vec3 back) MEMBER_CONST {
  if (!on_surface(p)) return 1.0f;
  float albedo = largest(p.color);
  if (is_layered(p)) {
    albedo = largest(coated_albedo(p, standing_at(p, back)));
    if (scene_has_panes) albedo = albedo * reciprocal(max(presence_at(p.triangle, back), 1e-6f));
  }
  return min(max(albedo, 0.05f), 1.0f);
}

/// Share of what the surface emits along w that its clear coat lets through.
SHARED float emission_under_coat(Point p, vec3 w) MEMBER_CONST {
  if (!is_layered(p) || !has_coat(p.bsdf)) return 1.0f;
  return coat_left_over(p.bsdf.coat, seen_from(p, w).coat.z);
}

/// Whether the way along `away` begins within an absorbing solid.
SHARED bool begins_within(Point p, vec3 away) MEMBER_CONST {
  return on_surface(p) && dot(p.normal, away) < 0.0f &&
         (load_material(p.material).flags & MATERIAL_ABSORBS) != 0u;
}
/// Share of light that gets along the inside of an absorbing solid from a to b, d long; d is 0
/// where one end is infinitely far: the sun is in no solid.
SHARED vec3 transmittance(Point a, Point b, vec3 w, float d) MEMBER_CONST {
  if (!scene_has_absorption || a.source == SOURCE_SKY || b.source == SOURCE_SKY) return vec3(1.0f);
  bool in_a = begins_within(a, w);
  if (!in_a && !begins_within(b, -w)) return vec3(1.0f);
  vec3 absorption = load_material(in_a ? a.material : b.material).absorption;
  return vec3(exponential(-absorption.x * d), exponential(-absorption.y * d),
              exponential(-absorption.z * d));
}

#include "shaders/shared/language_end.h"
