// A surface under a clear coat as one, each about its own normal: the text of
// tools/tdpt-render/path/coated.cpp in floats.
//
// Read behind bsdf.h, within the same scope.

#include "shaders/shared/language.h"

SHARED bool same_normals(Point p) MEMBER_CONST {
  return p.bsdf.coat.normal == vec3(0.0f, 0.0f, 1.0f);
}

/// A direction as both see it.
struct Seen {
  float side;  ///< cosine to the geometric normal
  vec3 base;
  vec3 coat;  ///< mirrored to the front
  bool on_base;
  bool on_coat;
};
SHARED Seen seen_from(Point p, vec3 w) MEMBER_CONST {
  Seen seen;
  seen.side = dot(p.normal, w);
  seen.base = to_local(onb_about(p.shading), w);
  seen.coat = seen.base;
  if (!same_normals(p)) seen.coat = to_local(onb_about(p.bsdf.coat.normal), seen.base);
  bool inside = seen.side < 0.0f && !p.bsdf.thin && transmits(p.bsdf);
  seen.on_base = seen.side < 0.0f ? seen.base.z < 0.0f : seen.side > 0.0f && seen.base.z > 0.0f;
  seen.on_coat = seen.side < 0.0f ? seen.coat.z < 0.0f : seen.side > 0.0f && seen.coat.z > 0.0f;
  seen.on_coat = seen.on_coat && !inside;
  if (seen.side < 0.0f) seen.coat.z = -seen.coat.z;
  return seen;
}
SHARED bool both_on_base(Seen a, Seen b) MEMBER_CONST {
  return a.on_base && b.on_base;
}
SHARED bool both_on_coat(Seen a, Seen b) MEMBER_CONST {
  return a.on_coat && b.on_coat && (a.side < 0.0f) == (b.side < 0.0f);
}

/// That the coat is taken, in proportion to what it reflects and what else leaves.
SHARED float coat_probability(Bsdf b, Seen from) MEMBER_CONST {
  if (!from.on_coat) return 0.0f;
  if (!from.on_base) return 1.0f;
  // Facets reflect more than their mean at some angles.
  float e = 1.0f - coat_left_over(b.coat, from.coat.z) + 0.02f * b.coat.strength;
  return 3.0f * e * reciprocal(max(3.0f * e + sum_of(bsdf_albedo(b, from.base)), 1e-30f));
}

/// A Dirac lobe that leads from `back` to `to`.
struct DiracLobe {
  float probability;  ///< that it is taken
  vec3 reflectance;   ///< or transmittance, of basic radiance
  float cos_back;     ///< to the normal it is reflected about
  float cos_to;
  float n_back;  ///< index of refraction on the two sides
  float n_to;
};

/// Where both are smooth, both lead there if their normals are the same; else the one whose normal
/// is nearer to the half vector.
SHARED DiracLobe coated_dirac(Point p, Seen back, Seen to) MEMBER_CONST {
  float taken = coat_probability(p.bsdf, back);
  DiracLobe base;
  base.probability = 0.0f;
  base.reflectance = vec3(0.0f);
  base.cos_back = 0.0f;
  base.cos_to = 0.0f;
  base.n_back = 1.0f;
  base.n_to = 1.0f;
  DiracLobe top = base;
  if (both_on_base(back, to)) {
    base.probability = (1.0f - taken) * bsdf_dirac_probability(p.bsdf, back.base, to.base);
    base.reflectance = bsdf_dirac_reflectance(p.bsdf, back.base, to.base);
    base.cos_back = back.base.z;
    base.cos_to = to.base.z;
    base.n_back = index_at(p.bsdf, back.base);
    base.n_to = index_at(p.bsdf, to.base);
  }
  if (!coat_smooth(p.bsdf.coat) || !both_on_coat(back, to)) return base;
  top.probability = taken;
  top.reflectance = vec3(coat_reflectance(p.bsdf.coat, back.coat.z));
  top.cos_back = back.coat.z;
  top.cos_to = to.coat.z;
  if (!(base.probability > 0.0f)) return top;
  if (same_normals(p)) {
    base.probability += top.probability;
    base.reflectance += top.reflectance;
    return base;
  }
  vec3 h = back.base + to.base;
  if (abs(dot(h, p.bsdf.coat.normal)) > abs(h.z)) return top;
  return base;
}

/// Radiance BSDF, l towards the light, c towards the camera.
SHARED vec3 coated_f(Point p, Seen l, Seen c) MEMBER_CONST {
  vec3 f = vec3(0.0f);
  float over_side = reciprocal(max(abs(l.side), 1e-12f));
  if (both_on_base(l, c)) {
    float n = index_at(p.bsdf, c.base);
    f = bsdf_f(p.bsdf, l.base, c.base) * (n * n * abs(l.base.z) * over_side);
  }
  if (both_on_coat(l, c)) f += vec3(coat_f(p.bsdf.coat, l.coat, c.coat) * l.coat.z * over_side);
  return f;
}

SHARED float coated_pdf_w(Point p, Seen back, Seen to) MEMBER_CONST {
  float taken = coat_probability(p.bsdf, back);
  float pdf_w = 0.0f;
  if (both_on_coat(back, to)) pdf_w = taken * coat_pdf_w(p.bsdf.coat, back.coat, to.coat);
  if (both_on_base(back, to)) pdf_w += (1.0f - taken) * bsdf_pdf_w(p.bsdf, back.base, to.base);
  return pdf_w;
}

/// As bsdf_turn(), with `to` in the shading frame; `by_coat`: which of the two was taken.
SHARED bool coated_turn(Point p, Seen here, float u, float v, float choice, OUT(vec3) to,
                        OUT(bool) dirac, OUT(bool) by_coat) MEMBER_CONST {
  float taken = coat_probability(p.bsdf, here);
  by_coat = choice < taken;
  if (!by_coat) {
    to = vec3(0.0f);
    dirac = false;
    float rest = (choice - taken) * reciprocal(max(1.0f - taken, 1e-30f));
    return here.on_base && bsdf_turn(p.bsdf, here.base, min(rest, 0.99999994f), u, v, to, dirac);
  }
  dirac = coat_smooth(p.bsdf.coat);
  if (!coat_turn(p.bsdf.coat, here.coat, u, v, to)) return false;
  if (here.side < 0.0f) to.z = -to.z;
  if (!same_normals(p)) to = to_world(onb_about(p.bsdf.coat.normal), to);
  return true;
}

SHARED vec3 coated_albedo(Point p, vec3 back) MEMBER_CONST {
  Seen here = seen_from(p, back);
  vec3 albedo = vec3(0.0f);
  if (here.on_base) albedo = bsdf_albedo(p.bsdf, here.base);
  if (here.on_coat) albedo += vec3(1.0f - coat_left_over(p.bsdf.coat, here.coat.z));
  return albedo;
}

SHARED Odds coated_odds(Point p, vec3 back) MEMBER_CONST {
  Seen here = seen_from(p, back);
  float taken = coat_probability(p.bsdf, here);
  Odds odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (here.on_base) odds = bsdf_odds(p.bsdf, here.base);
  odds.dirac = (1.0f - taken) * odds.dirac + (coat_smooth(p.bsdf.coat) ? taken : 0.0f);
  odds.broad = (1.0f - taken) * odds.broad + (p.bsdf.coat.alpha >= kNarrowAlpha ? taken : 0.0f);
  if (odds.dirac > 0.0f) odds.broad = 1.0f;
  return odds;
}

#include "shaders/shared/language_end.h"
