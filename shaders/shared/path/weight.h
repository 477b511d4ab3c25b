// The MIS weight of a finished path: the share of the strategy that made it in the densities of all
// strategies that could have made it. Sections 3.1 and 3.3, eqs. 6 to 8.
//
// x_0 ... x_k  vertices, x_0 on a light, x_k on the camera; k edges
// P>, P<       density [per canonical area] of a vertex in a walk from the light, from the camera
// s, a         split: number of vertices from the light
// p_AA = G D   density of a portal segment [eq. 4, portals.h]
//
//   camera    s=0        prod_{i>=0} P<(x_i)
//   direct    s=1        p_nee(x_0) prod_{i>=1} P<(x_i)         p_nee may depend on x_1
//   light     s=k        prod_{i<k} P>(x_i)
//   bi        s=2..k-1   prod_{i<s} P>(x_i) prod_{i>=s} P<(x_i)                             [eq. 7]
//   portal a  a=0..k-2   prod_{i<a} P>(x_i) p_AA(x_a,x_{a+1}) prod_{i>a+1} P<(x_i)          [eq. 8]
//
// At a vertex where this path scatters by a Dirac lobe (a mirror, smooth glass) nothing can be
// connected: techniques that would end a prefix or a segment there, or connect one to it, have
// density 0. A light without a surface has no P<(x_0).
//
// Method: multiple importance sampling (Veach), balance or power heuristic. A path is a chain of
// light vertices, up to two vertices of a portal segment, and a chain of camera vertices. The
// weight is computed from the joint outwards. R(s) is the density of the path with s vertices from
// the light and no segment, divided by that of the strategy used, so that
//   R(i) = R(i+1) P<(x_i) / P>(x_i)   at a vertex of the light's chain,
//   R(i+1) = R(i) P>(x_i) / P<(x_i)   at one of the camera's,
// and a segment x_a -> x_{a+1} has R(a+2) p_AA / (P>(x_a) P>(x_{a+1})) or the same by P<. All
// divisors are densities of the strategy used, hence positive. These numbers need an exponent of
// their own [scaled.h]: what leaves the range of a float along a long path may come back.
//
// Include where `render`, mixture_techniques (bits), power_heuristic, load_path_density() and
// scene_has_portals are.

#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/scaled.h"

#include "shaders/shared/language.h"

SHARED bool has_technique(uint technique) MEMBER_CONST {
  return ((mixture_techniques >> technique) & 1u) != 0u;
}

// Factor of a strategy's density for paths of k edges [Mixture::sample_weight]; 0 if the mixture
// does not have it.
SHARED REAL weight_of_split(uint s, uint k) MEMBER_CONST {
  if (s == 0u) return has_technique(TECHNIQUE_CAMERA) ? 1.0f : 0.0f;
  if (s == k) return has_technique(TECHNIQUE_LIGHT) ? render.light_walks : 0.0f;
  return s > 1u && has_technique(TECHNIQUE_BI) ? render.connected : 0.0f;
}
SHARED REAL weight_of_direct(uint k) MEMBER_CONST {
  if (!has_technique(TECHNIQUE_DIRECT)) return 0.0f;
  return k == 2u ? render.first_direct : render.later_direct;
}
SHARED REAL weight_of_portal(uint a, uint k) MEMBER_CONST {
  if (!has_technique(TECHNIQUE_PORTAL)) return 0.0f;
  REAL n = render.segments * (a > 0u ? render.connected_to_segments : 1.0f);
  return a + 2u == k ? n : n * render.segments_connected;
}

/// Adds a strategy: `relative` is its density over that of the strategy used, for one sample each;
/// it counts n times.
SHARED void add_strategy(INOUT(Scaled) total, Scaled relative, REAL n) MEMBER_CONST {
  if (n == 0.0f) return;
  Scaled p = product(relative, n);
  if (power_heuristic) p = product(p, p);
  total = sum(total, p);
}

/// Whether the path scatters by a Dirac lobe at the second vertex of a half.
SHARED bool turns_sharply_behind(OF_REAL(Half) part) MEMBER_CONST {
  if (part.slot == kNoVertex) return false;
  uint prev = load_path_density(part.slot).prev;
  return prev != kNoVertex && (load_path_density(prev).flags & VERTEX_DIRAC) != 0u;
}

/// Adds the strategies whose joint lies within one half of a path of k edges: the light's, x_{s-1}
/// to x_0, or the camera's, x_s to x_{k-1}. at_joint: R(s). `nee_A`: of x_0 as a next event at x_1,
/// if the light's half is x_0 alone; else it is taken from the records.
SHARED void add_half(INOUT(Scaled) total, OF_REAL(Half) part, bool of_light, uint s, uint k,
                     Scaled at_joint, REAL nee_A) MEMBER_CONST {
  Scaled R = at_joint;
  Scaled R_before = R;               // one vertex nearer to the joint
  Scaled own_before = scaled(1.0f);  // of that vertex
  bool dirac_before = false;         // of it,
  bool dirac_before2 = false;        // and of the one before
  REAL pair_before = 0.0f;
  REAL survival_before = 1.0f;
  REAL next_event_A = nee_A;
  uint slot = part.slot;
  uint count = of_light ? s : k - s;
  for (uint n = 0u; n < count; ++n) {
    uint i = of_light ? s - 1u - n : s + n;
    PathDensity d = load_path_density(slot);
    Scaled own = scaled(d.own_A);
    bool dirac = n > 0u && (d.flags & VERTEX_DIRAC) != 0u;
    bool dirac_behind = n + 1u < count && (load_path_density(d.prev).flags & VERTEX_DIRAC) != 0u;
    if (scene_has_portals && pair_before > 0.0f && !dirac && !dirac_behind && !dirac_before &&
        !dirac_before2)
      add_strategy(total, quotient(product(R_before, pair_before), product(own, own_before)),
                   weight_of_portal(of_light ? i : i - 1u, k));
    if (i == 0u) {
      REAL direct_A = of_light ? next_event_A : d.nee_A;
      if (direct_A > 0.0f && !(of_light ? dirac_before : dirac_behind))
        add_strategy(total, product(quotient(R, own), direct_A), weight_of_direct(k));
    }
    // Survival of the other walk at the vertex before, whose number in it this is.
    uint number = of_light ? k - i - 1u : i - 1u;
    REAL survived = (i == 0u && !of_light) || number <= 1u ? 1.0f : survival_before;
    REAL other = n == 0u ? part.first_A : n == 1u ? part.second_A : survived * d.other_A;
    R_before = R;
    R = quotient(product(R, other), own);
    if (!dirac && !dirac_behind) add_strategy(total, R, weight_of_split(of_light ? i : i + 1u, k));
    own_before = own;
    dirac_before2 = dirac_before;
    dirac_before = dirac;
    pair_before = d.pair_A;
    survival_before = d.other_survival;
    next_event_A = d.nee_A;
    slot = d.prev;
  }
}

/// The weight [eq. 6] of the strategy used, which counts n times, given the total of all.
SHARED REAL share_of(REAL n, Scaled total) MEMBER_CONST {
  Scaled mine = scaled(n);
  if (power_heuristic) mine = product(mine, mine);
  return narrowed(quotient(mine, total));
}

// Totals over all strategies, each times its factor, divided by the density of the one used.

/// For a path of k >= 2 edges, connected between x_{s-1} and x_s (s = 0: the camera walk hit a
/// light; s = k: the camera sees the last light vertex). `pair_A`: p_AA of the connecting edge,
/// unused for s of 0 and k.
SHARED Scaled strategies_of_connected(OF_REAL(Half) light, OF_REAL(Half) camera, uint s, uint k,
                                      REAL pair_A) MEMBER_CONST {
  Scaled one = scaled(1.0f);
  Scaled total = scaled(0.0f);
  add_strategy(total, one, weight_of_split(s, k));
  if (scene_has_portals && s > 0u && s < k && pair_A > 0.0f && !turns_sharply_behind(light) &&
      !turns_sharply_behind(camera)) {
    Scaled made =
        product(scaled(load_path_density(light.slot).own_A), load_path_density(camera.slot).own_A);
    add_strategy(total, quotient(scaled(pair_A), made), weight_of_portal(s - 1u, k));
  }
  if (s > 0u) add_half(total, light, true, s, k, one, 0.0f);
  if (s < k) add_half(total, camera, false, s, k, one, 0.0f);
  return total;
}

/// For a next event x_0 of density nee_A at the vertex x_1 of a camera walk. `light_A`, `camera_A`:
/// densities of x_0 in walks; `pair_A`: p_AA of x_0 -> x_1.
SHARED Scaled strategies_of_next_event(OF_REAL(Half) camera, uint k, REAL nee_A, REAL light_A,
                                       REAL camera_A, REAL pair_A) MEMBER_CONST {
  Scaled nee = scaled(nee_A);
  Scaled total = scaled(0.0f);
  add_strategy(total, scaled(1.0f), weight_of_direct(k));
  add_strategy(total, quotient(scaled(camera_A), nee), weight_of_split(0u, k));
  if (scene_has_portals && pair_A > 0.0f && !turns_sharply_behind(camera)) {
    Scaled made = product(nee, load_path_density(camera.slot).own_A);
    add_strategy(total, quotient(scaled(pair_A), made), weight_of_portal(0u, k));
  }
  add_half(total, camera, false, 1u, k, quotient(scaled(light_A), nee), 0.0f);
  return total;
}

SHARED Scaled strategies_of_segment(OF_REAL(Half) light, OF_REAL(Half) camera, uint a, uint k,
                                    OF_REAL(SegmentDensities) x) MEMBER_CONST {
  Scaled p = scaled(x.pair_A);
  Scaled total = scaled(0.0f);
  add_strategy(total, scaled(1.0f), weight_of_portal(a, k));
  Scaled by_camera = quotient(product(scaled(x.camera_A0), x.camera_A1), p);
  Scaled by_both = quotient(product(scaled(x.light_A0), x.camera_A1), p);
  Scaled by_light = quotient(product(scaled(x.light_A0), x.light_A1), p);
  add_strategy(total, by_camera, weight_of_split(a, k));
  add_strategy(total, by_both, weight_of_split(a + 1u, k));
  add_strategy(total, by_light, weight_of_split(a + 2u, k));
  if (a == 0u) {
    add_strategy(total, quotient(product(scaled(x.nee_A), x.camera_A1), p), weight_of_direct(k));
  } else {
    if (x.pair_before > 0.0f && !turns_sharply_behind(light)) {
      Scaled made = product(p, load_path_density(light.slot).own_A);
      add_strategy(total, quotient(product(scaled(x.pair_before), x.camera_A1), made),
                   weight_of_portal(a - 1u, k));
    }
    add_half(total, light, true, a, k, by_camera, x.nee_A);
  }
  if (a + 2u < k) {
    if (x.pair_after > 0.0f && !turns_sharply_behind(camera)) {
      Scaled made = product(p, load_path_density(camera.slot).own_A);
      add_strategy(total, quotient(product(scaled(x.pair_after), x.light_A0), made),
                   weight_of_portal(a + 1u, k));
    }
    add_half(total, camera, false, a + 2u, k, by_light, 0.0f);
  }
  return total;
}

#include "shaders/shared/language_end.h"
