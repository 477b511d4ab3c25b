// What a point does with light: simple or in layers, with a coat or without. The text of
// tools/tdpt-render/path/{point.h,surface.cpp,roulette.cpp} in floats.
//
// Read behind coated.h, within a scope that has faces[] and materials[], too.

#include "shaders/shared/language.h"

/// A direction as the surface under its coat sees it: local, and whether it lies on one side of
/// both normals.
SHARED bool in_shading_frame(Point p, vec3 w, OUT(vec3) local) MEMBER_CONST {
  local = to_local(onb_about(p.shading), w);
  float side = dot(p.normal, w);
  return side < 0.0f ? local.z < 0.0f : side > 0.0f && local.z > 0.0f;
}

SHARED bool is_layered(Point p) MEMBER_CONST {
  return scene_has_layers && !p.simple;
}

/// Radiance BSDF without Dirac lobes [1/sr]; unit directions away from the surface.
SHARED vec3 bsdf_at(Point p, vec3 to_light, vec3 to_camera) MEMBER_CONST {
  if (!is_layered(p)) return same_side(p, to_light, to_camera) ? p.color * kInversePi : vec3(0.0f);
  if (has_coat(p.bsdf)) return coated_f(p, seen_from(p, to_light), seen_from(p, to_camera));
  vec3 l;
  vec3 c;
  bool l_is_on = in_shading_frame(p, to_light, l);
  if (!in_shading_frame(p, to_camera, c) || !l_is_on) return vec3(0.0f);
  float n = index_at(p.bsdf, c);
  float side = max(abs(dot(p.normal, to_light)), 1e-12f);
  return bsdf_f(p.bsdf, l, c) * (n * n * abs(l.z) * reciprocal(side));
}

/// Density of scattering along `to` when the walk came along unit `back`, away from the surface
/// [1/sr]. `dirac`: by a Dirac lobe: its probability times n_to^2 |cos_to|, the density per
/// n^2 |cos| dw, which reflection and refraction preserve.
SHARED float scatter_pdf_w(Point at, vec3 back, vec3 to, bool dirac) MEMBER_CONST {
  if (!is_layered(at)) {
    float cosine = dot(at.normal, to);
    return !dirac && dot(at.normal, back) * cosine > 0.0f ? abs(cosine) * kInversePi : 0.0f;
  }
  if (has_coat(at.bsdf)) {
    Seen from = seen_from(at, back);
    Seen next = seen_from(at, to);
    if (!dirac) return coated_pdf_w(at, from, next);
    DiracLobe lobe = coated_dirac(at, from, next);
    return lobe.probability * lobe.n_to * lobe.n_to * abs(lobe.cos_to);
  }
  vec3 f;
  vec3 t;
  bool f_is_on = in_shading_frame(at, back, f);
  if (!in_shading_frame(at, to, t) || !f_is_on) return 0.0f;
  if (!dirac) return bsdf_pdf_w(at.bsdf, f, t);
  float n = index_at(at.bsdf, t);
  return bsdf_dirac_probability(at.bsdf, f, t) * (n * n * abs(t.z));
}

/// The next direction given: `t` is by a lobe that is not Dirac.
SHARED bool turn_towards(Point p, uint from, vec3 back, vec3 w, OUT(Turn) t) MEMBER_CONST {
  t.w = w;
  t.dirac = false;
  t.weight = p.color;
  if (!is_layered(p)) return same_side(p, back, w);
  float pdf_w = scatter_pdf_w(p, back, w, false);
  if (!(pdf_w > 1e-36f)) return false;
  bool from_camera = from == FROM_CAMERA;
  vec3 f = bsdf_at(p, from_camera ? w : back, from_camera ? back : w);
  t.weight = f * (abs(dot(p.normal, w)) * reciprocal(pdf_w));
  return true;
}

/// By the Dirac lobe of a point that was taken, to t.w.
SHARED bool turn_by_dirac(Point p, uint from, vec3 back, INOUT(Turn) t) MEMBER_CONST {
  DiracLobe lobe;
  if (has_coat(p.bsdf)) {
    lobe = coated_dirac(p, seen_from(p, back), seen_from(p, t.w));
  } else {
    vec3 b;
    vec3 to;
    bool b_is_on = in_shading_frame(p, back, b);
    if (!in_shading_frame(p, t.w, to) || !b_is_on) return false;
    lobe.probability = bsdf_dirac_probability(p.bsdf, b, to);
    lobe.reflectance = bsdf_dirac_reflectance(p.bsdf, b, to);
    lobe.cos_back = b.z;
    lobe.cos_to = to.z;
    lobe.n_back = index_at(p.bsdf, b);
    lobe.n_to = index_at(p.bsdf, to);
  }
  if (!(lobe.probability > 1e-30f)) return false;
  // f = reflectance * n_c^2 |l.ns| / |l.ng| per n^2 |cos| dw; l towards the light, c the camera.
  float n = lobe.n_back * reciprocal(lobe.n_to);
  float factor = n * n;
  if (from != FROM_CAMERA)
    factor = abs(lobe.cos_back * dot(p.normal, t.w)) *
             reciprocal(max(abs(dot(p.normal, back) * lobe.cos_to), 1e-30f));
  t.weight = lobe.reflectance * (factor * reciprocal(lobe.probability));
  return true;
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
  bool by_coat = false;
  if (has_coat(p.bsdf)) {
    if (!coated_turn(p, seen_from(p, back), u, v, choice, to, t.dirac, by_coat)) return false;
  } else {
    vec3 local_back;
    if (!in_shading_frame(p, back, local_back)) return false;
    if (!bsdf_turn(p.bsdf, local_back, choice, u, v, to, t.dirac)) return false;
  }
  t.w = normalized(to_world(onb_about(p.shading), to));
  // Bent normals may send it to a side where the lobe that it comes from is not seen.
  if (by_coat) {
    if (!both_on_coat(seen_from(p, back), seen_from(p, t.w))) return false;
  } else {
    float side = dot(p.normal, t.w);
    if (!(side < 0.0f ? to.z < 0.0f : side > 0.0f && to.z > 0.0f)) return false;
  }
  if (t.dirac) return turn_by_dirac(p, from, back, t);
  return turn_towards(p, from, back, t.w, t);
}

SHARED Odds odds_at(Point p, vec3 back) MEMBER_CONST {
  Odds odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (!is_layered(p)) return odds;
  if (has_coat(p.bsdf)) return coated_odds(p, back);
  vec3 local_back;
  if (!in_shading_frame(p, back, local_back)) return odds;
  return bsdf_odds(p.bsdf, local_back);
}

/// Probability that a ray along `w`, of any length, finds a pane; 1 of all else.
SHARED float presence_at(uint triangle, vec3 w) MEMBER_CONST {
  if (!scene_has_panes) return 1.0f;
  SurfaceMaterial m = materials[faces[triangle].material];
  if (!(m.pane_share > 0.0f)) return 1.0f;
  vec3 unit = normalized(brought_near_1(w));
  FresnelCurve f = schlick_curve(min(abs(dot(faces[triangle].normal, unit)), 1.0f));
  return 1.0f - m.pane_share * ((1.0f - m.pane_f90) + (m.pane_f90 - m.pane_f0) * f.rest);
}

/// Albedo of a surface as it is seen along unit `back`: the largest component, but 0.05 at least, 1
/// at most; 1 off surfaces. Of a pane, that of the share of rays that find it.
SHARED float albedo_at(Point p, vec3 back) MEMBER_CONST {
  if (!on_surface(p)) return 1.0f;
  float albedo = largest(p.color);
  if (is_layered(p)) {
    albedo = largest(has_coat(p.bsdf) ? coated_albedo(p, back)
                                      : bsdf_albedo(p.bsdf, to_local(onb_about(p.shading), back)));
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
         (materials[p.material].flags & MATERIAL_ABSORBS) != 0u;
}
/// Share of light that gets along the inside of an absorbing solid from a to b, d long; d is 0
/// where one end is infinitely far: the sun is in no solid.
SHARED vec3 transmittance(Point a, Point b, vec3 w, float d) MEMBER_CONST {
  if (!scene_has_absorption || a.source == SOURCE_SKY || b.source == SOURCE_SKY) return vec3(1.0f);
  bool in_a = begins_within(a, w);
  if (!in_a && !begins_within(b, -w)) return vec3(1.0f);
  vec3 absorption = materials[in_a ? a.material : b.material].absorption;
  return vec3(exponential(-absorption.x * d), exponential(-absorption.y * d),
              exponential(-absorption.z * d));
}

#include "shaders/shared/language_end.h"
