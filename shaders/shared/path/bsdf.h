// Scattering at one point of a surface, in the shading frame: the text of
// tools/tdpt-render/path/bsdf/bsdf.cpp in floats. Its header says what the lobes are; f here is the
// same symmetric one of basic radiance.
//
// Letters: h half vector or microfacet normal, mu cosine to z, E directional albedo of the
// interface, n index of refraction.
//
// Read behind interface_albedo.h, sheen.h and coat.h, within the same scope, which has
// scene_has_transmission, scene_has_sheen and scene_has_coats, too; warp.h, ggx.h and fresnel.h
// come before.

#include "shaders/shared/language.h"

SHARED bool is_positive(vec3 c) MEMBER_CONST {
  return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f;
}
SHARED float sum_of(vec3 c) MEMBER_CONST {
  return c.x + c.y + c.z;
}
SHARED vec3 not_below_0(vec3 c) MEMBER_CONST {
  return vec3(max(c.x, 0.0f), max(c.y, 0.0f), max(c.z, 0.0f));
}
SHARED float quotient_or_0(float a, float b) MEMBER_CONST {
  return b > 1e-30f ? a * reciprocal(b) : 0.0f;
}

SHARED bool transmits(Bsdf b) MEMBER_CONST {
  return scene_has_transmission && is_positive(b.through);
}
SHARED bool has_sheen(Bsdf b) MEMBER_CONST {
  return scene_has_sheen && b.sheen_alpha > 0.0f;
}
SHARED bool has_coat(Bsdf b) MEMBER_CONST {
  return scene_has_coats && b.coat.strength > 0.0f;
}
/// Index of refraction on the side of w.
SHARED float index_at(Bsdf b, vec3 w) MEMBER_CONST {
  return w.z < 0.0f && !b.thin && transmits(b) ? b.eta : 1.0f;
}

/// The surface as `from` sees it: mirrored, if need be, so that from.z > 0.
struct View {
  vec3 from;
  bool back;
  bool passes;  ///< transmits
  bool solid;
  bool interfaced;
  bool diffuse;
  bool sheen;
  float alpha;   ///< 0: smooth
  float ratio;   ///< index behind the interface / before it, for Fresnel
  float rise;    ///< ratio - 1
  float n_from;  ///< index where directions live
  float n_behind;
  vec3 left;  ///< 1 - E, what the interface leaves to the diffuse lobe along `from`
};

/// 1 - E of an interface.
SHARED vec3 interface_left_over(Bsdf b, InterfaceAlbedo e) MEMBER_CONST {
  return not_below_0(vec3(1.0f) - (b.f0 * e.a + b.f90 * e.b));
}
SHARED vec3 left_over(Bsdf b, View view, float mu) MEMBER_CONST {
  return view.interfaced ? interface_left_over(b, interface_albedo(mu, view.alpha)) : vec3(1.0f);
}

SHARED vec3 turned(View view, vec3 w) MEMBER_CONST {
  return view.back ? vec3(w.x, w.y, -w.z) : w;
}
SHARED View view_of(Bsdf b, vec3 from) MEMBER_CONST {
  View view;
  view.back = from.z < 0.0f;
  view.from = turned(view, from);
  view.passes = transmits(b);
  view.solid = view.passes && !b.thin;
  view.interfaced = view.passes || is_positive(b.f90);
  bool inside = view.solid && view.back;
  view.diffuse = is_positive(b.diffuse) && !inside;
  view.sheen = has_sheen(b) && !inside;
  float rise = b.eta - 1.0f;
  bool even = b.alpha < kSmoothAlpha || (view.solid && abs(rise) < kMatchedIndices);
  view.alpha = even ? 0.0f : b.alpha;
  view.ratio = inside ? reciprocal(b.eta) : b.eta;
  view.rise = inside ? -rise * view.ratio : rise;
  view.n_from = inside ? b.eta : 1.0f;
  view.n_behind = view.solid && !view.back ? b.eta : 1.0f;
  view.left = left_over(b, view, view.from.z);
  return view;
}
SHARED bool is_rough(View view) MEMBER_CONST {
  return view.interfaced && view.alpha > 0.0f;
}
SHARED bool is_smooth(View view) MEMBER_CONST {
  return view.interfaced && !(view.alpha > 0.0f);
}

/// What the interface reflects, and the rest; both of basic radiance.
struct Reflectance {
  vec3 back;
  vec3 rest;
};

/// At a cosine to the (microfacet's) normal; q: refracted_q().
SHARED Reflectance reflectance_at(Bsdf b, View view, float cosine, float q) MEMBER_CONST {
  float c = min(cosine, 1.0f);
  Reflectance r;
  FresnelCurve curve;
  if (!view.passes) {
    curve = schlick_curve(c);
  } else {
    r.back = vec3(1.0f);
    r.rest = vec3(0.0f);
    if (q < 0.0f) return r;
    if (is_positive(b.diffuse))
      curve = schlick_curve(view.ratio >= 1.0f ? c : min(q * reciprocal(view.ratio), 1.0f));
    else
      curve = exact_curve(c, q, view.ratio, view.rise);
  }
  vec3 way = b.f90 - b.f0;
  r.back = b.f0 + way * curve.part;
  r.rest = (vec3(1.0f) - b.f90) + way * curve.rest;
  return r;
}

SHARED Reflectance reflectance_at(Bsdf b, View view, float cosine) MEMBER_CONST {
  return reflectance_at(b, view, cosine, refracted_q(cosine, view.ratio, view.rise));
}

/// What the layers above let through: a coat along both directions, a sheen along them together.
struct Covers {
  float from;
  float to;
  float sheen;
};

/// What a coat leaves along a direction that is turned as view.from is, and what the sheen does.
SHARED float under_coat_along(Bsdf b, View view, vec3 w) MEMBER_CONST {
  bool inside = view.solid && (w.z < 0.0f) != view.back;
  if (!has_coat(b) || inside) return 1.0f;
  return coat_left_over(b.coat, dot(turned(view, w), b.coat.normal));
}
SHARED float under_sheen_along(Bsdf b, View view, vec3 w) MEMBER_CONST {
  bool inside = view.solid && (w.z < 0.0f) != view.back;
  if (!has_sheen(b) || inside) return 1.0f;
  return 1.0f - largest(b.sheen) * sheen_albedo(abs(w.z), b.sheen_alpha);
}
SHARED Covers covers_along(Bsdf b, View view, vec3 to) MEMBER_CONST {
  Covers covers;
  covers.from = under_coat_along(b, view, view.from);
  covers.to = under_coat_along(b, view, to);
  covers.sheen = min(under_sheen_along(b, view, view.from), under_sheen_along(b, view, to));
  return covers;
}

/// 2 int (1 - E) c mu dmu, as if interface and coat had one normal.
SHARED vec3 average_under_coat(Bsdf b) MEMBER_CONST {
  View view = view_of(b, vec3(0.0f, 0.0f, 1.0f));
  vec3 mean = vec3(0.0f);
  for (uint i = 0u; i < kGaussNodes; ++i) {
    float x = load_surface_curve(kGauss + 2u * i);
    float weight = load_surface_curve(kGauss + 2u * i + 1u);
    for (int side = 0; side < 2; ++side) {
      float mu = side == 0 ? 0.5f - x : 0.5f + x;
      mean += left_over(b, view, mu) * (2.0f * mu * weight * coat_left_over(b.coat, mu));
    }
  }
  return mean;
}

/// Diffuse lobe [1/sr] to another direction on this side.
SHARED vec3 diffuse_lobe(Bsdf b, View view, float mu_to, Covers covers) MEMBER_CONST {
  vec3 d = b.diffuse * kInversePi;
  if (!view.interfaced && !has_coat(b)) return d;
  vec3 p = view.left * left_over(b, view, mu_to);
  vec3 mean = vec3(1.0f);
  if (has_coat(b)) {
    p = p * (covers.from * covers.to);
    mean = b.under_coat;
  } else {
    mean = interface_left_over(b, interface_albedo_average(view.alpha));
  }
  return d *
         vec3(quotient_or_0(p.x, mean.x), quotient_or_0(p.y, mean.y), quotient_or_0(p.z, mean.z));
}

/// That the diffuse lobe is taken and not the interface, below a sheen; -1: there is neither.
SHARED float diffuse_or_interface(Bsdf b, View view) MEMBER_CONST {
  if (!view.diffuse) return view.interfaced ? 0.0f : -1.0f;
  if (!view.interfaced) return 1.0f;
  float d = sum_of(b.diffuse * view.left);
  float i = 0.0f;
  if (is_smooth(view)) {
    Reflectance r = reflectance_at(b, view, view.from.z);
    i = sum_of(r.back) + sum_of(r.rest * b.through);
  } else {
    // Microfacets reflect more than their mean at some angles: never starve them.
    i = sum_of(vec3(1.0f) - view.left + view.left * b.through) + 1e-3f * sum_of(b.f90);
  }
  return d + i > 1e-30f ? d * reciprocal(d + i) : -1.0f;
}

/// Probabilities that a lobe is taken; the interface has the rest. diffuse < 0: none is.
struct Shares {
  float diffuse;
  float sheen;
};
SHARED Shares shares_of(Bsdf b, View view) MEMBER_CONST {
  Shares shares;
  shares.diffuse = diffuse_or_interface(b, view);
  shares.sheen = 0.0f;
  if (!view.sheen) return shares;
  float e = sheen_albedo(view.from.z, b.sheen_alpha);
  float s = sum_of(b.sheen) * max(e, 0.05f);
  float under = 0.0f;
  if (view.diffuse) under += sum_of(b.diffuse);
  if (view.interfaced) under += sum_of(b.f90);  // at most
  under = min(under, 3.0f) * (1.0f - largest(b.sheen) * e);
  bool alone = shares.diffuse < 0.0f;
  shares.sheen = alone ? 1.0f : s * reciprocal(s + under);
  shares.diffuse = alone ? 0.0f : (1.0f - shares.sheen) * shares.diffuse;
  return shares;
}

/// Probabilities that the interface, once taken, reflects and that it transmits; both 0: neither.
struct Split {
  float reflect;
  float transmit;
};
SHARED Split split_of(Bsdf b, View view, Reflectance at) MEMBER_CONST {
  Split split;
  split.reflect = 1.0f;
  split.transmit = 0.0f;
  if (!view.passes) return split;
  float r = sum_of(at.back);
  float t = sum_of(at.rest * b.through);
  float over = r + t > 1e-30f ? reciprocal(r + t) : 0.0f;
  split.reflect = r * over;
  split.transmit = t * over;
  return split;
}

/// Microfacet that joins view.from and `to` (mirrored like it) and how densely it does.
struct Facet {
  vec3 h;
  float cosine;      ///< from.h > 0
  float q;           ///< refracted_q(); of what is refracted by the cosine behind, which keeps f
                     ///< symmetric where it nearly grazes
  float dh_dto;      ///< solid angle of h per solid angle of `to`
  float f_jacobian;  ///< f = Fresnel part * D * G2/(cos cos) * this
  bool joins;
};
SHARED Facet facet_between(View view, vec3 to) MEMBER_CONST {
  Facet facet;
  facet.h = vec3(0.0f, 0.0f, 1.0f);
  facet.cosine = 0.0f;
  facet.q = 0.0f;
  facet.dh_dto = 0.0f;
  facet.f_jacobian = 0.0f;
  facet.joins = false;
  bool reflects = to.z > 0.0f;
  if (!(view.from.z > kRoughGrazing) || !(abs(to.z) > kRoughGrazing)) return facet;
  if (!reflects && !view.passes) return facet;
  bool mirrored = reflects || !view.solid;
  vec3 h = view.from + (reflects || view.solid ? to : vec3(to.x, to.y, -to.z));
  // Near 1 the indices' rises are all that counts.
  if (!mirrored) h = h + (view.from * (view.n_from - 1.0f) + to * (view.n_behind - 1.0f));
  float l2 = dot(h, h);
  if (!(l2 > 1e-20f)) return facet;
  float over_l = inverse_root(l2);
  facet.h = h * (!mirrored && h.z < 0.0f ? -over_l : over_l);
  facet.cosine = dot(view.from, facet.h);
  float cos_to = mirrored ? facet.cosine : -dot(to, facet.h);
  facet.joins = facet.cosine > 0.0f && cos_to > 0.0f;
  if (!facet.joins) return facet;
  if (mirrored) {
    facet.q = refracted_q(facet.cosine, view.ratio, view.rise);
    facet.dh_dto = 0.25f * reciprocal(facet.cosine);
    facet.f_jacobian = 0.25f * reciprocal(view.n_from * view.n_from);  // of basic radiance
  } else {
    float scale = cos_to * (over_l * over_l);  // (n_from from.h + n_to to.h)^2 = l^2
    facet.q = view.ratio * cos_to;
    facet.dh_dto = view.n_behind * view.n_behind * scale;
    facet.f_jacobian = facet.cosine * scale;
  }
  return facet;
}

/// What leads from one direction to another.
struct Lobes {
  vec3 f;       ///< symmetric [1/sr]; of a Dirac lobe: reflectance or transmittance
  float pdf_w;  ///< of bsdf_turn(), the choice of the lobe included [1/sr]; of a Dirac lobe: how
                ///< probable it is
};

/// The lobes that are not Dirac, or, by `dirac`, the one that is: reflection on the same side,
/// transmission on the other. 0 where a direction lies in the surface.
SHARED Lobes bsdf_lobes(Bsdf b, View view, Shares shares, vec3 to, bool dirac) MEMBER_CONST {
  Lobes lobes;
  lobes.f = vec3(0.0f);
  lobes.pdf_w = 0.0f;
  if (!(view.from.z > kInSurface) || !(abs(to.z) > kInSurface)) return lobes;
  vec3 w = turned(view, to);
  bool reflects = w.z > 0.0f;
  Covers covers = covers_along(b, view, w);
  float under = min(covers.from, covers.to);
  if (!dirac && reflects) {
    if (view.diffuse) lobes.f = diffuse_lobe(b, view, w.z, covers);
    lobes.pdf_w = max(shares.diffuse, 0.0f) * w.z * kInversePi;
    if (view.sheen) lobes.pdf_w += shares.sheen * (0.5f * kInversePi);
  }
  Facet m = facet_between(view, w);
  if (view.interfaced && dirac == is_smooth(view) && (dirac || m.joins)) {
    float c = dirac ? view.from.z : m.cosine;
    float q = dirac ? refracted_q(c, view.ratio, view.rise) : m.q;
    Reflectance r = reflectance_at(b, view, c, q);
    Split split = split_of(b, view, r);
    float share = shares.diffuse < 0.0f ? 0.0f : 1.0f - (shares.diffuse + shares.sheen);
    share = share * (reflects ? split.reflect : split.transmit);
    float per_f = under;
    if (!dirac) {
      float d = ggx_d(m.h, view.alpha);
      share = share * d * ggx_g1_over_cos(view.from.z, view.alpha) * m.cosine * m.dh_dto;
      per_f = per_f * d * ggx_g2_over_cos(view.from.z, abs(w.z), view.alpha) * m.f_jacobian;
    }
    lobes.f += (reflects ? r.back : r.rest * b.through) * per_f;
    lobes.pdf_w += share;
  }
  if (has_sheen(b)) {
    lobes.f = lobes.f * covers.sheen;
    if (view.sheen && !dirac && reflects)
      lobes.f += b.sheen * (sheen_f(view.from, w, b.sheen_alpha) * under);
  }
  return lobes;
}

/// Directional albedo: the share that leaves of what comes from view.from.
SHARED vec3 bsdf_albedo(Bsdf b, View view) MEMBER_CONST {
  if (view.solid && view.back && is_rough(view)) return vec3(1.0f);  // all, beyond some angle
  vec3 left = vec3(1.0f);
  if (is_smooth(view)) left = reflectance_at(b, view, view.from.z).rest;
  if (is_rough(view)) left = view.left;
  vec3 behind = b.through;
  if (view.diffuse) behind += b.diffuse;
  vec3 all = vec3(1.0f) - left + left * behind;
  if (has_sheen(b)) {
    all = all * under_sheen_along(b, view, view.from);
    if (view.sheen) all += b.sheen * sheen_albedo(view.from.z, b.sheen_alpha);
  }
  return all * under_coat_along(b, view, view.from);
}

/// Takes a lobe and a direction from it; three numbers in [0,1). False when the walk is absorbed.
SHARED bool bsdf_turn(Bsdf b, View view, Shares shares, float choice, float u, float v,
                      OUT(vec3) to, OUT(bool) dirac) MEMBER_CONST {
  to = vec3(0.0f);
  dirac = false;
  if (!(view.from.z > kInSurface)) return false;
  if (shares.diffuse < 0.0f) return false;
  float p = shares.diffuse + shares.sheen;
  if (choice < p || !view.interfaced) {
    vec3 w = cosine_hemisphere(u, v);
    if (view.sheen && choice >= shares.diffuse) {
      float r = root(u * (2.0f - u));
      cos_sin_turns(v, w.x, w.y);
      w = vec3(r * w.x, r * w.y, 1.0f - u);
    }
    to = turned(view, w);
    return choice < p && w.z > 0.0f;
  }
  vec3 h = vec3(0.0f, 0.0f, 1.0f);
  if (is_rough(view)) {
    if (!(view.from.z > kRoughGrazing)) return false;
    h = ggx_visible_normal(view.from, view.alpha, u, v);
    if (!(h.z > kUprightFacet)) return false;
  }
  float c = dot(view.from, h);
  if (!(c > 0.0f)) return false;
  Split split = split_of(b, view, reflectance_at(b, view, c));
  if (!(split.reflect + split.transmit > 0.0f)) return false;
  bool reflects = split.transmit <= 0.0f || choice - p < split.reflect * (1.0f - p);
  vec3 w = h * (2.0f * c) - view.from;
  if (!reflects && view.solid) {
    float q = refracted_q(c, view.ratio, view.rise);
    if (q < 0.0f) return false;
    // h (c / ratio - q / ratio) - from / ratio, where c - q is rise (ratio + 1) / -(c + q).
    float bend = view.rise * (view.ratio + 1.0f) * reciprocal(max(c + q, 1e-30f));
    w = h * -bend - view.from;
    if (is_smooth(view)) w.z = -q;
    w = w * reciprocal(view.ratio);
  }
  if (!reflects && !view.solid) {
    if (!(w.z > 0.0f)) return false;
    w = is_smooth(view) ? -view.from : vec3(w.x, w.y, -w.z);
  }
  dirac = is_smooth(view);
  float least = dirac ? 0.0f : kRoughGrazing;
  if (!(reflects ? w.z > least : w.z < -least)) return false;
  to = turned(view, normalized(w));
  return true;
}

/// Whether some lobe is not Dirac, so that connections can be made here.
SHARED bool bsdf_connectible(Bsdf b) MEMBER_CONST {
  return is_positive(b.diffuse) || has_sheen(b) || is_rough(view_of(b, vec3(0.0f, 0.0f, 1.0f)));
}

SHARED Odds bsdf_odds(Bsdf b, View view, Shares shares) MEMBER_CONST {
  float broad = max(shares.diffuse + shares.sheen, 0.0f);
  bool dirac = is_smooth(view) && shares.diffuse >= 0.0f;
  Odds odds;
  odds.dirac = dirac ? 1.0f - broad : 0.0f;
  odds.broad = odds.dirac == 0.0f && b.alpha < kNarrowAlpha ? broad : 1.0f;
  return odds;
}

#include "shaders/shared/language_end.h"
