// A surface together with its clear coat, if any; each scatters about its own normal.
//
// The map that bends the surface's normal does not bend the coat's; the coat may have a map of its
// own. Light may be above one normal and below the other; then only one of the two scatters it. The
// coat is chosen with a probability that depends on `back` alone, 0 without a coat.
//
// Include after bsdf.h, in the same scope.

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
  Layers layers;
  layers.base = VEC3(0.0f);
  layers.coat = 0.0f;
  layers.pdf_w = 0.0f;
  layers.by_coat = false;
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
  OF_REAL(Odds) odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (here.seen.on_base) odds = bsdf_odds(p.bsdf, here.view, here.shares);
  if (!has_coat(p.bsdf)) return odds;
  REAL taken = here.coat;
  odds.dirac = (1.0f - taken) * odds.dirac + (coat_smooth(p.bsdf.coat) ? taken : REAL(0.0f));
  odds.broad =
      (1.0f - taken) * odds.broad + (p.bsdf.coat.alpha >= kNarrowAlpha ? taken : REAL(0.0f));
  if (odds.dirac > 0.0f) odds.broad = 1.0f;
  return odds;
}

#include "shaders/shared/language_end.h"
