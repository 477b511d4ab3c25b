// Scattering at a point, simple or layered, coated or not: the BSDF, the next direction of a walk,
// and absorption along an edge. A surface and its clear coat scatter about normals of their own.
//
// The map that bends the surface's normal does not bend the coat's; the coat may have a map of its
// own. Light may be above one normal and below the other; then only one of the two scatters it. The
// coat is chosen with a probability that depends on `back` alone, 0 without a coat.
//
// The radiance BSDF is used with geometric cosines everywhere: if the shading normal ns differs
// from the geometric normal ng, f(to_light, to_camera) carries |to_light.ns| / |to_light.ng| (Veach
// 5.3), and a direction above one of them and below the other is dark. So walks from either end
// agree.
//
// Include after bsdf.h, in the same scope, which has for a Point p
//   bool on_surface(p), is_in_sky(p), same_side(p, a, b)
//   VEC3 absorption_of(p)       of an absorbing solid, else 0
//   REAL opacity_of(p, back)    probability that a pane stops a ray along `back`; else 1

#include "shaders/shared/language.h"

SHARED bool same_normals(IN(Point) p) MEMBER_CONST {
  return VEC3(p.bsdf.coat.normal) == VEC3(0.0f, 0.0f, 1.0f);
}

/// A direction in the frames of both.
struct Seen {
  REAL side;  ///< cosine to the geometric normal
  VEC3 base;
  VEC3 coat;  ///< mirrored to the front
  bool on_base;
  bool on_coat;
};
SHARED Seen seen_from(IN(Point) p, VEC3 w) MEMBER_CONST {
  Seen seen;
  seen.side = dot(p.normal, w);
  bool below = seen.side < 0.0f;
  seen.base = to_local(onb_about(p.shading), w);
  seen.on_base = below ? seen.base.z < 0.0f : seen.side > 0.0f && seen.base.z > 0.0f;
  seen.coat = seen.base;
  seen.on_coat = false;
  if (!has_coat(p.bsdf)) return seen;
  if (!same_normals(p)) seen.coat = to_local(onb_about(VEC3(p.bsdf.coat.normal)), seen.base);
  seen.on_coat = below ? seen.coat.z < 0.0f : seen.side > 0.0f && seen.coat.z > 0.0f;
  bool inside = below && p.bsdf.thin == 0u && transmits(p.bsdf);
  seen.on_coat = seen.on_coat && !inside;
  if (below) seen.coat.z = -seen.coat.z;
  return seen;
}
SHARED bool both_on_base(IN(Seen) a, IN(Seen) b) MEMBER_CONST {
  return a.on_base && b.on_base;
}
SHARED bool both_on_coat(IN(Seen) a, IN(Seen) b) MEMBER_CONST {
  return a.on_coat && b.on_coat && (a.side < 0.0f) == (b.side < 0.0f);
}

/// What a walk knows where it scatters, having arrived along `seen`.
struct ScatterContext {
  Seen seen;
  OrientedBsdf view;
  LobeProbabilities shares;
  REAL coat;  ///< probability that the coat is chosen
};

/// In proportion to the coat's reflectance and the albedo of the rest.
SHARED REAL coat_probability(IN(Bsdf) b, IN(Seen) from, IN(OrientedBsdf) view) MEMBER_CONST {
  if (!from.on_coat) return 0.0f;
  if (!from.on_base) return 1.0f;
  // At some angles facets reflect more than their mean.
  REAL e = 1.0f - coat_left_over(b.coat, from.coat.z) + REAL(0.02) * b.coat.strength;
  return 3.0f * e * reciprocal(max(3.0f * e + sum_of(bsdf_albedo(b, view)), 1e-30f));
}
SHARED ScatterContext scatter_context_at(IN(Point) p, VEC3 back) MEMBER_CONST {
  ScatterContext here;
  here.seen = seen_from(p, back);
  here.view = view_of(p.bsdf, here.seen.base);
  here.shares = lobe_probabilities_of(p.bsdf, here.view);
  here.coat = coat_probability(p.bsdf, here.seen, here.view);
  return here;
}

/// Scattering from `back` to `to` by the surface and by its coat; if their normals differ, each
/// uses its own cosines.
struct Layers {
  VEC3 base;     ///< f, or reflectance for basic radiance
  REAL coat;     ///< the same of the coat, colourless
  REAL pdf_w;    ///< or probability, for a Dirac lobe
  bool by_coat;  ///< the Dirac lobe is the coat's alone
};

/// Which Dirac lobe connects the directions if both are smooth: both if their normals are the same,
/// else the one whose normal is nearer to the half vector.
SHARED bool coat_is_nearer(IN(Point) p, IN(Seen) back, IN(Seen) to) MEMBER_CONST {
  VEC3 h = back.base + to.base;
  return abs(dot(h, VEC3(p.bsdf.coat.normal))) > abs(h.z);
}

SHARED Layers layers_between(IN(Point) p, IN(ScatterContext) here, IN(Seen) to,
                             bool dirac) MEMBER_CONST {
  Seen back = here.seen;
  Layers layers = {VEC3(0.0f), 0.0f, 0.0f, false};
  REAL taken = here.coat;
  if (both_on_base(back, to)) {
    Lobes lobes = bsdf_lobes(p.bsdf, here.view, here.shares, to.base, dirac);
    layers.base = lobes.f;
    layers.pdf_w = (1.0f - taken) * lobes.pdf_w;
  }
  if (!both_on_coat(back, to)) return layers;
  if (!dirac) {
    layers.coat = coat_f(p.bsdf.coat, back.coat, to.coat);
    layers.pdf_w += taken * coat_pdf_w(p.bsdf.coat, back.coat, to.coat);
  } else if (coat_smooth(p.bsdf.coat)) {
    bool base_leads = layers.pdf_w > 0.0f;
    if (base_leads && !same_normals(p) && !coat_is_nearer(p, back, to)) return layers;
    bool alone = !base_leads || !same_normals(p);
    layers.coat = coat_reflectance(p.bsdf.coat, back.coat.z);
    layers.by_coat = alone;
    layers.base = alone ? VEC3(0.0f) : layers.base;
    layers.pdf_w = alone ? taken : layers.pdf_w + taken;
  }
  return layers;
}

/// Like bsdf_turn(), with `to` in the shading frame; `by_coat`: which of the two was chosen.
SHARED bool coated_turn(IN(Point) p, IN(ScatterContext) here, REAL u, REAL v, REAL choice,
                        OUT(VEC3) to, OUT(bool) dirac, OUT(bool) by_coat) MEMBER_CONST {
  REAL taken = here.coat;
  by_coat = choice < taken;
  if (!by_coat) {
    to = VEC3(0.0f);
    dirac = false;
    if (!here.seen.on_base) return false;
    REAL rest = choice;
    if (taken > 0.0f)
      rest = min((choice - taken) * reciprocal(max(1.0f - taken, 1e-30f)), 0.99999994f);
    return bsdf_turn(p.bsdf, here.view, here.shares, rest, u, v, to, dirac);
  }
  dirac = coat_smooth(p.bsdf.coat);
  if (!coat_turn(p.bsdf.coat, here.seen.coat, u, v, to)) return false;
  if (here.seen.side < 0.0f) to.z = -to.z;
  if (!same_normals(p)) to = to_world(onb_about(VEC3(p.bsdf.coat.normal)), to);
  return true;
}

SHARED VEC3 coated_albedo(IN(Point) p, IN(ScatterContext) here) MEMBER_CONST {
  VEC3 albedo = VEC3(0.0f);
  if (here.seen.on_base || !has_coat(p.bsdf)) albedo = bsdf_albedo(p.bsdf, here.view);
  if (here.seen.on_coat) albedo += VEC3(1.0f - coat_left_over(p.bsdf.coat, here.seen.coat.z));
  return albedo;
}

SHARED OF_REAL(Odds) coated_odds(IN(Point) p, IN(ScatterContext) here) MEMBER_CONST {
  OF_REAL(Odds) odds = {0.0f, 1.0f};
  if (here.seen.on_base) odds = bsdf_odds(p.bsdf, here.view, here.shares);
  if (!has_coat(p.bsdf)) return odds;
  REAL taken = here.coat;
  odds.dirac = (1.0f - taken) * odds.dirac + (coat_smooth(p.bsdf.coat) ? taken : REAL(0.0f));
  odds.broad =
      (1.0f - taken) * odds.broad + (p.bsdf.coat.alpha >= kNarrowAlpha ? taken : REAL(0.0f));
  if (odds.dirac > 0.0f) odds.broad = 1.0f;
  return odds;
}

SHARED bool is_layered(IN(Point) p) MEMBER_CONST {
  return scene_has_layers && !p.simple;
}

/// Converts f to radiance, light along l, seen from c: factor n_c^2 |l.ns| / |l.ng| for the base,
/// |l.ns| / |l.ng| for the coat.
SHARED VEC3 of_radiance(IN(Point) p, IN(Layers) layers, IN(Seen) l, IN(Seen) c) MEMBER_CONST {
  REAL n = index_at(p.bsdf, c.base);
  REAL per_side = reciprocal(max(abs(l.side), 1e-12f));
  return layers.base * (n * n * abs(l.base.z) * per_side) +
         VEC3(layers.coat * abs(l.coat.z) * per_side);
}

/// Radiance BSDF without Dirac lobes [1/sr]; unit directions point away from the surface.
SHARED VEC3 bsdf_at(IN(Point) p, VEC3 to_light, VEC3 to_camera) MEMBER_CONST {
  if (!is_layered(p))
    return same_side(p, to_light, to_camera) ? VEC3(p.color) * INVERSE_PI : VEC3(0.0f);
  ScatterContext l = scatter_context_at(p, to_light);
  Seen c = seen_from(p, to_camera);
  return of_radiance(p, layers_between(p, l, c, false), l.seen, c);
}

/// n_to^2 |cos_to| of a Dirac lobe, about the normal that reflects it.
SHARED REAL dirac_measure(IN(Point) p, IN(Layers) layers, IN(Seen) to) MEMBER_CONST {
  if (layers.by_coat) return abs(to.coat.z);
  REAL n = index_at(p.bsdf, to.base);
  return n * n * abs(to.base.z);
}

/// Density of scattering along `to` of a walk that arrived along unit `back`, away from the surface
/// [1/sr]. `dirac`: by a Dirac lobe: its probability times n_to^2 |cos_to|, the density per n^2
/// |cos| dw, which reflection and refraction preserve. For a simple point:
SHARED REAL simple_pdf_w(IN(Point) p, VEC3 back, VEC3 to, bool dirac) MEMBER_CONST {
  REAL cosine = dot(p.normal, to);
  return !dirac && dot(p.normal, back) * cosine > 0.0f ? abs(cosine) * INVERSE_PI : REAL(0.0f);
}
SHARED REAL layered_pdf_w(IN(Point) p, IN(ScatterContext) here, VEC3 to, bool dirac) MEMBER_CONST {
  Seen next = seen_from(p, to);
  Layers layers = layers_between(p, here, next, dirac);
  return dirac ? layers.pdf_w * dirac_measure(p, layers, next) : layers.pdf_w;
}
SHARED REAL scatter_pdf_w(IN(Point) p, VEC3 back, VEC3 to, bool dirac) MEMBER_CONST {
  if (!is_layered(p)) return simple_pdf_w(p, back, to, dirac);
  return layered_pdf_w(p, scatter_context_at(p, back), to, dirac);
}

/// f cos / pdf_w from `back` to `to`, or reflectance / probability; false if that is impossible.
SHARED bool weigh(IN(Point) p, uint from, IN(ScatterContext) here, IN(Seen) to, bool dirac,
                  OUT(VEC3) weight) MEMBER_CONST {
  Layers layers = layers_between(p, here, to, dirac);
  Seen back = here.seen;
  weight = VEC3(0.0f);
  if (!(layers.pdf_w > 1e-30f)) return false;
  bool from_camera = from == FROM_CAMERA;
  REAL over_pdf = reciprocal(layers.pdf_w);
  if (dirac) {
    // f = reflectance n_c^2 |l.ns| / |l.ng| per n^2 |cos| dw.
    REAL n = index_at(p.bsdf, back.base) * reciprocal(index_at(p.bsdf, to.base));
    REAL factor = layers.by_coat ? REAL(1.0f) : n * n;
    if (!from_camera)
      factor = abs((layers.by_coat ? back.coat.z : back.base.z) * to.side) *
               reciprocal(max(abs(back.side * (layers.by_coat ? to.coat.z : to.base.z)), 1e-30f));
    weight = (layers.base + VEC3(layers.coat)) * (factor * over_pdf);
  } else {
    VEC3 f = from_camera ? of_radiance(p, layers, to, back) : of_radiance(p, layers, back, to);
    weight = f * (abs(to.side) * over_pdf);
  }
  return true;
}

/// Samples the next direction of a walk that arrived along unit `back`. u, v: direction; `choice`:
/// of a lobe. False if the walk ends here; t.dirac then says whether a Dirac lobe was chosen: bent
/// normals may reflect into the surface.
SHARED bool simple_turn(IN(Point) p, VEC3 back, REAL u, REAL v, OUT(OF_REAL(Turn)) t) MEMBER_CONST {
  VEC3 n = dot(p.normal, back) > 0.0f ? p.normal : -p.normal;
  t.dirac = false;
  t.weight = VEC3(p.color);
  t.w = cosine_hemisphere(n, u, v);
  return true;
}
SHARED bool layered_turn(IN(Point) p, uint from, IN(ScatterContext) here, REAL u, REAL v,
                         REAL choice, OUT(OF_REAL(Turn)) t) MEMBER_CONST {
  VEC3 to;
  bool by_coat;
  t.dirac = false;
  t.weight = VEC3(0.0f);
  t.w = VEC3(0.0f);
  if (!coated_turn(p, here, u, v, choice, to, t.dirac, by_coat)) return false;
  t.w = normalized(to_world(onb_about(p.shading), to));
  Seen next = seen_from(p, t.w);
  // Bent normals may send it to a side where its lobe is not visible.
  if (!(by_coat ? both_on_coat(here.seen, next) : next.on_base)) return false;
  return weigh(p, from, here, next, t.dirac, t.weight);
}
SHARED bool turn(IN(Point) p, uint from, VEC3 back, REAL u, REAL v, REAL choice,
                 OUT(OF_REAL(Turn)) t) MEMBER_CONST {
  if (!is_layered(p)) return simple_turn(p, back, u, v, t);
  return layered_turn(p, from, scatter_context_at(p, back), u, v, choice, t);
}

/// The same for a given direction: `t` uses the lobes that are not Dirac.
SHARED bool layered_turn_towards(IN(Point) p, uint from, IN(ScatterContext) here, VEC3 w,
                                 OUT(OF_REAL(Turn)) t) MEMBER_CONST {
  t.w = w;
  t.dirac = false;
  return weigh(p, from, here, seen_from(p, w), false, t.weight);
}
SHARED bool turn_towards(IN(Point) p, uint from, VEC3 back, VEC3 w,
                         OUT(OF_REAL(Turn)) t) MEMBER_CONST {
  t.w = w;
  t.dirac = false;
  t.weight = VEC3(p.color);
  if (!is_layered(p)) return same_side(p, back, w);
  return layered_turn_towards(p, from, scatter_context_at(p, back), w, t);
}

SHARED OF_REAL(Odds) odds_at(IN(Point) p, VEC3 back) MEMBER_CONST {
  OF_REAL(Odds) odds = {0.0f, 1.0f};
  if (!is_layered(p)) return odds;
  return coated_odds(p, scatter_context_at(p, back));
}

SHARED REAL held_albedo(REAL albedo) MEMBER_CONST {
  return min(max(albedo, REAL(0.05)), 1.0f);
}
SHARED REAL simple_albedo(IN(Point) p) MEMBER_CONST {
  return on_surface(p) ? held_albedo(REAL(largest(p.color))) : REAL(1.0f);
}
SHARED REAL layered_albedo(IN(Point) p, IN(ScatterContext) here, VEC3 back) MEMBER_CONST {
  REAL albedo = largest(coated_albedo(p, here));
  if (scene_has_panes) albedo = albedo * reciprocal(opacity_of(p, back));
  return held_albedo(albedo);
}
/// Albedo of a surface as seen along unit `back`: the largest component, clamped to [0.05, 1]; 1
/// off surfaces. For a pane, the albedo for the rays that it stops.
SHARED REAL albedo_at(IN(Point) p, VEC3 back) MEMBER_CONST {
  if (!on_surface(p) || !is_layered(p)) return simple_albedo(p);
  return layered_albedo(p, scatter_context_at(p, back), back);
}

/// Share of the emission along w that passes the clear coat.
SHARED REAL emission_under_coat(IN(Point) p, VEC3 w) MEMBER_CONST {
  if (!is_layered(p) || !has_coat(p.bsdf)) return 1.0f;
  return coat_left_over(p.bsdf.coat, seen_from(p, w).coat.z);
}

/// 0 unless the way along `away` begins inside an absorbing solid.
SHARED VEC3 absorption_along(IN(Point) p, VEC3 away) MEMBER_CONST {
  return on_surface(p) && dot(p.normal, away) < 0.0f ? absorption_of(p) : VEC3(0.0f);
}
/// Transmittance of an absorbing solid between a and b, at distance d; the sky is in no solid.
SHARED VEC3 transmittance(IN(Point) a, IN(Point) b, VEC3 w, REAL d) MEMBER_CONST {
  if (!scene_has_absorption || is_in_sky(a) || is_in_sky(b)) return VEC3(1.0f);
  VEC3 absorption = absorption_along(a, w);
  if (is_zero(absorption)) absorption = absorption_along(b, -w);
  if (is_zero(absorption)) return VEC3(1.0f);
  return VEC3(exponential(-absorption.x * d), exponential(-absorption.y * d),
              exponential(-absorption.z * d));
}

#include "shaders/shared/language_end.h"
