// The BSDF at one point of a surface, after textures: glTF metallic-roughness with specular, ior,
// transmission and sheen, under an optional clear coat. The coat's own lobe, which may have another
// normal, is added in scatter.h.
//
// Directions are unit, point away from the surface and are given in the shading frame: z along the
// shading normal of the front side. `from` is where a walk came from, `to` where it goes.
//
// f is symmetric, f(a, b) = f(b, a), because it relates basic radiance L/n^2:
//   L_o / n_o^2 = int f (L_i / n_i^2) n_i^2 |cos_i| dw_i,   n = index_at(side).
// The radiance BSDF is f * n_o^2, n_o on the camera's side. Perfectly smooth (Dirac) lobes are kept
// apart. A walk's weight is f n_to^2 |cos_to| / pdf_w, or reflectance / probability: the mean is at
// most 1 on either side.
//
// Interface: GGX, height-correlated Smith, single scattering (energy lost to shadowing stays lost:
// rough metal and rough glass darken). Its reflectance goes from f0 to f90: if opaque, by Schlick's
// (1 - cos)^5; with `through`, by the exact curve of unpolarised light for eta, so that f0 =
// ((eta-1)/(eta+1))^2, f90 = 1 is exact; 1 under total reflection. A conductor's curve dips below
// Schlick's [microfacet.h]; E ignores this, which only makes walks live longer.
// Diffuse under it: diffuse/pi (1 - E(from)) (1 - E(to)) / (1 - E_avg), E the interface's
// directional albedo: white under any interface reflects all that the interface does not.
// Opaque and thin surfaces look the same from both sides. With both `diffuse` and `through`, whose
// sum must be at most 1 and eta at least 1, Schlick's curve (of the cosine in front) replaces the
// exact one in a solid, so that E stays known. Seen from inside such a solid, `glass`, the share of
// `through` in both, is interface, and the rest is bare paint on it. A thin sheet transmits by the
// reflected lobe, mirrored to the other side.
// The sheen lies above all but a coat [layers.h]. It leaves to the other lobes the lesser of 1 -
// max(colour) E_s along the two directions, as in KHR_materials_sheen. A coat leaves the lesser of
// c = 1 - E_c [layers.h]; to the diffuse lobe it leaves (1 - E) c at both ends over their common
// average, so that white under any coat is white. Inside a solid there is neither.
//
// Letters: h half vector or microfacet normal, mu cosine to z, E directional albedo of the
// interface, n index of refraction.
//
// Include after layers.h, in the same scope, which also has scene_has_transmission,
// scene_has_sheen, scene_has_coats, scene_has_textures and scene_has_panes.

#include "shaders/shared/language.h"

SHARED REAL quotient_or_0(REAL a, REAL b) MEMBER_CONST {
  return b > 1e-30f ? a * reciprocal(b) : REAL(0.0f);
}

SHARED bool transmits(IN(Bsdf) b) MEMBER_CONST {
  return scene_has_transmission && is_positive(b.through);
}
SHARED bool has_sheen(IN(Bsdf) b) MEMBER_CONST {
  return scene_has_sheen && b.sheen_alpha > 0.0f;
}
SHARED bool has_coat(IN(Bsdf) b) MEMBER_CONST {
  return scene_has_coats && b.coat.strength > 0.0f;
}
/// Index of refraction on the side of w.
SHARED REAL index_at(IN(Bsdf) b, VEC3 w) MEMBER_CONST {
  return w.z < 0.0f && b.thin == 0u && transmits(b) ? REAL(b.eta) : REAL(1.0f);
}

/// The surface as seen from `from`, mirrored if necessary so that from.z > 0.
struct OrientedBsdf {
  VEC3 from;
  bool back;
  bool passes;  ///< transmits
  bool solid;
  bool interfaced;
  bool diffuse;
  bool sheen;
  bool under;   ///< the diffuse lobe lies under the interface, not beside it
  REAL glass;   ///< share of the surface that is interface
  REAL alpha;   ///< 0: smooth
  REAL ratio;   ///< index behind the interface / in front of it, for Fresnel
  REAL rise;    ///< ratio - 1
  REAL n_from;  ///< index of refraction on the side of `from`
  REAL n_behind;
  InterfaceRow row;  ///< row of alpha; only for a diffuse lobe under an interface
  VEC3 left;         ///< 1 - E along `from`, likewise
};

/// 1 - E of an interface.
SHARED VEC3 interface_left_over(IN(Bsdf) b, InterfaceAlbedo e) MEMBER_CONST {
  return not_below_0(VEC3(1.0f) - (VEC3(b.f0) * e.a + VEC3(REAL(b.f90) * e.b)));
}
/// 1 - E over the diffuse lobe at cosine mu.
SHARED VEC3 left_over(IN(Bsdf) b, IN(OrientedBsdf) view, REAL mu) MEMBER_CONST {
  if (!view.under) return VEC3(1.0f);
  if (!(view.alpha > 0.0f)) return interface_left_over(b, smooth_interface_albedo(mu));
  return interface_left_over(b, interface_albedo_in(view.row, mu));
}

SHARED VEC3 turned(IN(OrientedBsdf) view, VEC3 w) MEMBER_CONST {
  return view.back ? VEC3(w.x, w.y, -w.z) : w;
}
SHARED OrientedBsdf view_of(IN(Bsdf) b, VEC3 from) MEMBER_CONST {
  OrientedBsdf view;
  view.back = from.z < 0.0f;
  view.from = turned(view, from);
  view.passes = transmits(b);
  view.solid = view.passes && b.thin == 0u;
  view.interfaced = view.passes || b.f90 > 0.0f;
  bool inside = view.solid && view.back;
  view.diffuse = is_positive(b.diffuse);
  view.under = view.interfaced && !inside;
  view.glass = 1.0f;
  if (view.diffuse && inside)
    view.glass = sum_of(VEC3(b.through)) * reciprocal(sum_of(VEC3(b.through) + VEC3(b.diffuse)));
  view.sheen = has_sheen(b) && !inside;
  REAL eta = REAL(b.eta);
  REAL rise = eta - 1.0f;
  bool even = b.alpha < kSmoothAlpha || (view.solid && abs(rise) < kMatchedIndices);
  view.alpha = even ? REAL(0.0f) : REAL(b.alpha);
  view.ratio = inside ? reciprocal(eta) : eta;
  view.rise = inside ? -rise * view.ratio : rise;
  view.n_from = inside ? eta : REAL(1.0f);
  view.n_behind = view.solid && !view.back ? eta : REAL(1.0f);
  view.left = VEC3(1.0f);
  view.row.node = 0u;
  view.row.rest = 0.0f;
  if (!view.diffuse || !view.under) return view;
  if (view.alpha > 0.0f) view.row = interface_row(view.alpha);
  view.left = left_over(b, view, view.from.z);
  return view;
}
SHARED bool is_rough(IN(OrientedBsdf) view) MEMBER_CONST {
  return view.interfaced && view.alpha > 0.0f;
}
SHARED bool is_smooth(IN(OrientedBsdf) view) MEMBER_CONST {
  return view.interfaced && !(view.alpha > 0.0f);
}

/// Reflectance of the interface, times `glass`, and its transmittance; both of basic radiance.
struct Reflectance {
  VEC3 back;
  VEC3 rest;
};

/// At a cosine to the (microfacet's) normal; q: refracted_q().
SHARED Reflectance reflectance_at(IN(Bsdf) b, IN(OrientedBsdf) view, REAL cosine,
                                  REAL q) MEMBER_CONST {
  REAL c = min(cosine, 1.0f);
  Reflectance r;
  OF_REAL(FresnelCurve) curve;
  if (!view.passes) {
    curve = schlick_curve(c);
  } else {
    r.back = VEC3(view.glass);
    r.rest = VEC3(0.0f);
    if (q < 0.0f) return r;
    if (is_positive(b.diffuse))
      curve = schlick_curve(view.ratio >= 1.0f ? c : min(q * reciprocal(view.ratio), 1.0f));
    else
      curve = exact_curve(c, q, view.ratio, view.rise);
  }
  REAL f90 = REAL(b.f90);
  VEC3 way = VEC3(f90) - VEC3(b.f0);
  r.back = (VEC3(b.f0) + way * curve.part) * view.glass;
  r.rest = VEC3(1.0f - f90) + way * curve.rest;
  if (view.passes || !is_positive(b.dip)) return r;
  VEC3 back = r.back;
  r.back = not_below_0(back - VEC3(b.dip) * (c * (1.0f - c) * curve.part));
  r.rest += back - r.back;
  return r;
}

SHARED Reflectance reflectance_at(IN(Bsdf) b, IN(OrientedBsdf) view, REAL cosine) MEMBER_CONST {
  REAL q = 0.0f;
  if (view.passes) q = refracted_q(cosine, view.ratio, view.rise);
  return reflectance_at(b, view, cosine, q);
}

/// Transmittance of the layers above: of a coat along either direction, of a sheen for both
/// together.
struct Covers {
  REAL from;
  REAL to;
  REAL sheen;
};

/// Transmittance of the coat along w, a direction turned like view.from; below: of the sheen.
SHARED REAL under_coat_along(IN(Bsdf) b, IN(OrientedBsdf) view, VEC3 w) MEMBER_CONST {
  bool inside = view.solid && (w.z < 0.0f) != view.back;
  if (!has_coat(b) || inside) return 1.0f;
  return coat_left_over(b.coat, dot(turned(view, w), VEC3(b.coat.normal)));
}
SHARED REAL under_sheen_along(IN(Bsdf) b, IN(OrientedBsdf) view, VEC3 w) MEMBER_CONST {
  bool inside = view.solid && (w.z < 0.0f) != view.back;
  if (!has_sheen(b) || inside) return 1.0f;
  return 1.0f - largest(b.sheen) * sheen_albedo(abs(w.z), REAL(b.sheen_alpha));
}
SHARED Covers covers_along(IN(Bsdf) b, IN(OrientedBsdf) view, VEC3 to) MEMBER_CONST {
  Covers covers = {1.0f, 1.0f, 1.0f};
  if (!has_coat(b) && !has_sheen(b)) return covers;
  covers.from = under_coat_along(b, view, view.from);
  covers.to = under_coat_along(b, view, to);
  covers.sheen = min(under_sheen_along(b, view, view.from), under_sheen_along(b, view, to));
  return covers;
}

/// 2 int (1 - E) c mu dmu, as if interface and coat had one normal.
SHARED VEC3 average_under_coat(IN(Bsdf) b) MEMBER_CONST {
  OrientedBsdf view = view_of(b, VEC3(0.0f, 0.0f, 1.0f));
  VEC3 mean = VEC3(0.0f);
  for (uint i = 0u; i < kGaussNodes; ++i) {
    REAL x = load_surface_curve(kGauss + 2u * i);
    REAL weight = load_surface_curve(kGauss + 2u * i + 1u);
    for (int side = 0; side < 2; ++side) {
      REAL mu = side == 0 ? 0.5f - x : 0.5f + x;
      mean += left_over(b, view, mu) * (2.0f * mu * weight * coat_left_over(b.coat, mu));
    }
  }
  return mean;
}

/// Diffuse lobe [1/sr] towards another direction on this side.
SHARED VEC3 diffuse_lobe(IN(Bsdf) b, IN(OrientedBsdf) view, REAL mu_to,
                         Covers covers) MEMBER_CONST {
  VEC3 d = VEC3(b.diffuse) * INVERSE_PI;
  if (view.interfaced && !view.under) return d * reciprocal(view.n_from * view.n_from);
  if (!view.interfaced && !has_coat(b)) return d;
  VEC3 p = view.left * left_over(b, view, mu_to);
  VEC3 mean = VEC3(1.0f);
  if (has_coat(b)) {
    p = p * (covers.from * covers.to);
    mean = VEC3(b.coat.under);
  } else {
    mean = interface_left_over(
        b, view.alpha > 0.0f ? interface_average_in(view.row) : smooth_interface_average());
  }
  return d *
         VEC3(quotient_or_0(p.x, mean.x), quotient_or_0(p.y, mean.y), quotient_or_0(p.z, mean.z));
}

/// Probability of the diffuse lobe, as against the interface, below a sheen; -1: there is neither.
SHARED REAL diffuse_or_interface(IN(Bsdf) b, IN(OrientedBsdf) view) MEMBER_CONST {
  if (!view.diffuse) return view.interfaced ? REAL(0.0f) : REAL(-1.0f);
  if (!view.interfaced) return 1.0f;
  REAL d = sum_of(VEC3(b.diffuse) * view.left);
  REAL i = 0.0f;
  if (is_smooth(view)) {
    Reflectance r = reflectance_at(b, view, view.from.z);
    i = sum_of(r.back) + sum_of(r.rest * VEC3(b.through));
  } else {
    // At some angles microfacets reflect more than their mean: keep a minimum probability.
    i = sum_of(VEC3(1.0f) - view.left + view.left * VEC3(b.through)) + 3e-3f * b.f90;
    if (!view.under) i = 3.0f * view.glass;
  }
  return d + i > 1e-30f ? d * reciprocal(d + i) : REAL(-1.0f);
}

/// Probabilities of the lobes; the rest is the interface's. diffuse < 0: there is no lobe.
struct LobeProbabilities {
  REAL diffuse;
  REAL sheen;
};
SHARED LobeProbabilities lobe_probabilities_of(IN(Bsdf) b, IN(OrientedBsdf) view) MEMBER_CONST {
  LobeProbabilities shares = {diffuse_or_interface(b, view), 0.0f};
  if (!view.sheen) return shares;
  REAL e = sheen_albedo(view.from.z, REAL(b.sheen_alpha));
  REAL s = sum_of(b.sheen) * max(e, 0.05f);
  REAL under = 0.0f;
  if (view.diffuse) under += sum_of(b.diffuse);
  if (view.interfaced) under += 3.0f * b.f90;  // upper bound
  under = min(under, 3.0f) * (1.0f - largest(b.sheen) * e);
  bool alone = shares.diffuse < 0.0f;
  shares.sheen = alone ? REAL(1.0f) : s * reciprocal(s + under);
  shares.diffuse = alone ? REAL(0.0f) : (1.0f - shares.sheen) * shares.diffuse;
  return shares;
}

/// Probabilities that the interface, once chosen, reflects or transmits; both 0: neither.
struct Split {
  REAL reflect;
  REAL transmit;
};
SHARED Split split_of(IN(Bsdf) b, IN(OrientedBsdf) view, Reflectance at) MEMBER_CONST {
  Split split = {1.0f, 0.0f};
  if (!view.passes) return split;
  REAL r = sum_of(at.back);
  REAL t = sum_of(at.rest * VEC3(b.through));
  REAL over = r + t > 1e-30f ? reciprocal(r + t) : REAL(0.0f);
  split.reflect = r * over;
  split.transmit = t * over;
  return split;
}

/// The microfacet that connects view.from and `to` (mirrored like it), with its Jacobians.
struct Facet {
  VEC3 h;
  REAL cosine;  ///< from.h > 0
  REAL q;  ///< refracted_q(); for refraction from the cosine behind, which keeps f symmetric near
           ///< grazing
  REAL dh_dto;      ///< solid angle of h per solid angle of `to`
  REAL f_jacobian;  ///< f = Fresnel part * D * G2/(cos cos) * this
  bool connects;
};
SHARED Facet facet_between(IN(OrientedBsdf) view, VEC3 to) MEMBER_CONST {
  Facet facet = {VEC3(0.0f, 0.0f, 1.0f), 0.0f, 0.0f, 0.0f, 0.0f, false};
  bool reflects = to.z > 0.0f;
  if (!(view.from.z > kRoughGrazing) || !(abs(to.z) > kRoughGrazing)) return facet;
  if (!reflects && !view.passes) return facet;
  bool mirrored = reflects || !view.solid;
  VEC3 h = view.from + (reflects || view.solid ? to : VEC3(to.x, to.y, -to.z));
  // Written with the indices' rises, which are all that counts near 1.
  if (!mirrored) h = h + (view.from * (view.n_from - 1.0f) + to * (view.n_behind - 1.0f));
  REAL l2 = dot(h, h);
  if (!(l2 > 1e-20f)) return facet;
  REAL over_l = inverse_root(l2);
  facet.h = h * (!mirrored && h.z < 0.0f ? -over_l : over_l);
  facet.cosine = dot(view.from, facet.h);
  REAL cos_to = mirrored ? facet.cosine : -dot(to, facet.h);
  facet.connects = facet.cosine > 0.0f && cos_to > 0.0f;
  if (!facet.connects) return facet;
  if (mirrored) {
    if (view.passes) facet.q = refracted_q(facet.cosine, view.ratio, view.rise);
    facet.dh_dto = 0.25f * reciprocal(facet.cosine);
    facet.f_jacobian = 0.25f * reciprocal(view.n_from * view.n_from);  // for basic radiance
  } else {
    REAL scale = cos_to * (over_l * over_l);  // (n_from from.h + n_to to.h)^2 = l^2
    facet.q = view.ratio * cos_to;
    facet.dh_dto = view.n_behind * view.n_behind * scale;
    facet.f_jacobian = facet.cosine * scale;
  }
  return facet;
}

/// Value and density of scattering from one direction to another.
struct Lobes {
  VEC3 f;      ///< symmetric [1/sr]; for a Dirac lobe: reflectance or transmittance
  REAL pdf_w;  ///< of bsdf_turn(), including the choice of the lobe [1/sr]; for a Dirac lobe: its
               ///< probability
};

/// All lobes that are not Dirac, or, if `dirac`, the one that is: reflection on the same side,
/// transmission on the other. 0 if a direction lies in the surface.
SHARED Lobes bsdf_lobes(IN(Bsdf) b, IN(OrientedBsdf) view, LobeProbabilities shares, VEC3 to,
                        bool dirac) MEMBER_CONST {
  Lobes lobes = {VEC3(0.0f), 0.0f};
  if (!(view.from.z > kInSurface) || !(abs(to.z) > kInSurface)) return lobes;
  VEC3 w = turned(view, to);
  bool reflects = w.z > 0.0f;
  Covers covers = covers_along(b, view, w);
  REAL under = min(covers.from, covers.to);
  if (!dirac && reflects) {
    if (view.diffuse) lobes.f = diffuse_lobe(b, view, w.z, covers);
    lobes.pdf_w = max(shares.diffuse, 0.0f) * w.z * INVERSE_PI;
    if (view.sheen) lobes.pdf_w += shares.sheen * (0.5f * INVERSE_PI);
  }
  Facet m = facet_between(view, w);
  if (view.interfaced && dirac == is_smooth(view) && (dirac || m.connects)) {
    REAL c = dirac ? view.from.z : m.cosine;
    REAL q = m.q;
    if (dirac && view.passes) q = refracted_q(c, view.ratio, view.rise);
    Reflectance r = reflectance_at(b, view, c, q);
    Split split = split_of(b, view, r);
    REAL share = shares.diffuse < 0.0f ? REAL(0.0f) : 1.0f - (shares.diffuse + shares.sheen);
    share = share * (reflects ? split.reflect : split.transmit);
    REAL per_f = under;
    if (!dirac) {
      REAL d = ggx_d(m.h, view.alpha);
      share = share * d * ggx_g1_over_cos(view.from.z, view.alpha) * m.cosine * m.dh_dto;
      per_f = per_f * d * ggx_g2_over_cos(view.from.z, abs(w.z), view.alpha) * m.f_jacobian;
    }
    lobes.f += (reflects ? r.back : r.rest * VEC3(b.through)) * per_f;
    lobes.pdf_w += share;
  }
  if (has_sheen(b)) {
    lobes.f = lobes.f * covers.sheen;
    if (view.sheen && !dirac && reflects)
      lobes.f += VEC3(b.sheen) * (sheen_f(view.from, w, REAL(b.sheen_alpha)) * under);
  }
  return lobes;
}

/// Directional albedo: the share of the light from view.from that leaves again.
SHARED VEC3 bsdf_albedo(IN(Bsdf) b, IN(OrientedBsdf) view) MEMBER_CONST {
  if (view.solid && view.back && is_rough(view)) return VEC3(1.0f);  // all, beyond some angle
  VEC3 left = VEC3(1.0f);
  if (is_smooth(view)) {
    Reflectance r = reflectance_at(b, view, view.from.z);
    left = r.rest;
    if (view.diffuse && !view.under) return r.back + r.rest * VEC3(b.through) + VEC3(b.diffuse);
  }
  if (is_rough(view))
    left = view.diffuse ? view.left
                        : interface_left_over(b, interface_albedo(view.from.z, view.alpha));
  VEC3 behind = VEC3(b.through);
  if (view.diffuse) behind += VEC3(b.diffuse);
  VEC3 all = VEC3(1.0f) - left + left * behind;
  if (has_sheen(b)) {
    all = all * under_sheen_along(b, view, view.from);
    if (view.sheen) all += VEC3(b.sheen) * sheen_albedo(view.from.z, REAL(b.sheen_alpha));
  }
  return all * under_coat_along(b, view, view.from);
}

/// Samples a lobe and a direction from it; three numbers in [0,1). False if the walk is absorbed.
SHARED bool bsdf_turn(IN(Bsdf) b, IN(OrientedBsdf) view, LobeProbabilities shares, REAL choice,
                      REAL u, REAL v, OUT(VEC3) to, OUT(bool) dirac) MEMBER_CONST {
  to = VEC3(0.0f);
  dirac = false;
  if (!(view.from.z > kInSurface)) return false;
  if (shares.diffuse < 0.0f) return false;
  REAL p = shares.diffuse + shares.sheen;
  if (choice < p || !view.interfaced) {
    VEC3 w = cosine_hemisphere(u, v);
    if (view.sheen && choice >= shares.diffuse) {
      REAL r = root(u * (2.0f - u));
      cos_sin_turns(v, w.x, w.y);
      w = VEC3(r * w.x, r * w.y, 1.0f - u);
    }
    to = turned(view, w);
    return choice < p && w.z > 0.0f;
  }
  VEC3 h = VEC3(0.0f, 0.0f, 1.0f);
  if (is_rough(view)) {
    if (!(view.from.z > kRoughGrazing)) return false;
    h = ggx_visible_normal(view.from, view.alpha, u, v);
    if (!(h.z > kUprightFacet)) return false;
  }
  REAL c = dot(view.from, h);
  if (!(c > 0.0f)) return false;
  Split split = split_of(b, view, reflectance_at(b, view, c));
  if (!(split.reflect + split.transmit > 0.0f)) return false;
  bool reflects = split.transmit <= 0.0f || choice - p < split.reflect * (1.0f - p);
  VEC3 w = h * (2.0f * c) - view.from;
  if (!reflects && view.solid) {
    REAL q = refracted_q(c, view.ratio, view.rise);
    if (q < 0.0f) return false;
    // h (c / ratio - q / ratio) - from / ratio, where c - q is rise (ratio + 1) / -(c + q).
    REAL bend = view.rise * (view.ratio + 1.0f) * reciprocal(max(c + q, 1e-30f));
    w = h * -bend - view.from;
    if (is_smooth(view)) w.z = -q;
    w = w * reciprocal(view.ratio);
  }
  if (!reflects && !view.solid) {
    if (!(w.z > 0.0f)) return false;
    w = is_smooth(view) ? -view.from : VEC3(w.x, w.y, -w.z);
  }
  dirac = is_smooth(view);
  REAL least = dirac ? REAL(0.0f) : REAL(kRoughGrazing);
  if (!(reflects ? w.z > least : w.z < -least)) return false;
  to = turned(view, normalized(w));
  return true;
}

/// Whether some lobe is not Dirac, so that connections are possible.
SHARED bool bsdf_connectible(IN(Bsdf) b) MEMBER_CONST {
  return is_positive(b.diffuse) || has_sheen(b) || is_rough(view_of(b, VEC3(0.0f, 0.0f, 1.0f)));
}

SHARED OF_REAL(Odds)
    bsdf_odds(IN(Bsdf) b, IN(OrientedBsdf) view, LobeProbabilities shares) MEMBER_CONST {
  REAL broad = max(shares.diffuse + shares.sheen, 0.0f);
  bool dirac = is_smooth(view) && shares.diffuse >= 0.0f;
  OF_REAL(Odds) odds;
  odds.dirac = dirac ? 1.0f - broad : REAL(0.0f);
  odds.broad = odds.dirac == 0.0f && b.alpha < kNarrowAlpha ? broad : REAL(1.0f);
  return odds;
}

/// Only diffuse, of colour `color`.
SHARED Bsdf diffuse_bsdf(vec3 color) MEMBER_CONST {
  vec3 none = vec3(0.0f);
  Coat coat = {vec3(0.0f, 0.0f, 1.0f), 0.0f, vec3(1.0f), 0.0f};
  // diffuse, thin, f0, f90, through, eta, sheen, sheen_alpha, dip, alpha, coat
  Bsdf b = {color, 0u, none, 0.0f, none, 1.0f, none, 0.0f, none, 1.0f, coat};
  return b;
}

/// The BSDF of a material after textures: glTF 2.0 appendix B with KHR_materials_specular, _ior and
/// _transmission. Dielectric and metal share one microfacet lobe, since Schlick's F is linear in f0
/// and f90.
SHARED Bsdf bsdf_of(IN(SurfaceMaterial) m) MEMBER_CONST {
  float dielectric = 1.0f - m.metallic;
  float r = (m.ior - 1.0f) * reciprocal(m.ior + 1.0f);
  vec3 f0 = m.specular_color * (r * r);
  f0 = vec3(min(f0.x, 1.0f), min(f0.y, 1.0f), min(f0.z, 1.0f)) * m.specular;
  Bsdf b = diffuse_bsdf(m.base_color * (dielectric * (1.0f - m.transmission)));
  b.f0 = m.base_color * m.metallic + f0 * dielectric;
  b.dip = m.dip * m.metallic;
  b.f90 = m.metallic + (m.ior != 1.0f ? m.specular * dielectric : 0.0f);
  if (scene_has_textures && (m.flags & MATERIAL_GLOSSY_MAP) != 0u)
    b.diffuse = b.diffuse * max(1.0f - largest(m.specular_color), 0.0f);
  bool pane = scene_has_panes && m.pane_share > 0.0f;
  if (!pane) b.through = m.base_color * (dielectric * m.transmission);  // rays pass through panes
  b.alpha = m.roughness * m.roughness;
  b.eta = m.ior;
  b.thin = (m.flags & MATERIAL_SOLID) == 0u ? 1u : 0u;
  if (scene_has_sheen && is_positive(m.sheen_color)) {
    float roughness = max(m.sheen_roughness, kLeastSheenRoughness);
    b.sheen = m.sheen_color;
    b.sheen_alpha = roughness * roughness;
  }
  b.coat.strength = m.coat;
  b.coat.alpha = m.coat_roughness * m.coat_roughness;
  return b;
}

/// Sets the material of a point that has more than a diffuse lobe; its shading normal is known.
/// coat_normal: unit, on the front; used only if bent_coat.
SHARED void put_material(IN(SurfaceMaterial) m, bool bent_coat, VEC3 coat_normal,
                         INOUT(Point) p) MEMBER_CONST {
  p.bsdf = bsdf_of(m);
  p.connectible = bsdf_connectible(p.bsdf);
  if (!has_coat(p.bsdf)) return;
  p.connectible = p.connectible || !coat_smooth(p.bsdf.coat);
  if (bent_coat) p.bsdf.coat.normal = vec3(normalized(to_local(onb_about(p.shading), coat_normal)));
  if (is_positive(p.bsdf.diffuse)) p.bsdf.coat.under = vec3(average_under_coat(p.bsdf));
}

#include "shaders/shared/language_end.h"
