// All code on surfaces, for kernels and their scalar build: material at a point, and its
// scattering. Users call the functions of place.h and scatter.h, and surface_stops() and
// coverage_at() of coverage.h.
//
// Include in a scope that has
//   Real, in C++                  float
//   load_face(i) and all others of TABLES_OF_SURFACES [tables.h]
//   bool scene_has_layers         some point is more than diffuse about the geometric normal
//        scene_has_normals        some face has a shading normal of its own, apart from maps
//        scene_has_textures, scene_has_colours, scene_has_coats, scene_has_sheen,
//        scene_has_transmission, scene_has_absorption, scene_has_panes
//        scene_has_coverage, coverage_has_textures
// a GLSL file after its buffers, or the body of a C++ struct.

#include "shaders/shared/path/tables.h"

#include "shaders/shared/path/layers.h"

#include "shaders/shared/path/bsdf.h"

#include "shaders/shared/path/mapped.h"

#include "shaders/shared/path/place.h"

#include "shaders/shared/path/scatter.h"

#include "shaders/shared/coverage.h"

#include "shaders/shared/language.h"

/// Scattering at the end of a walk that arrived at `p` from unit `back`, for the direction w
/// (unit). `dirac`: by a Dirac lobe; then f is meaningless. survival_behind is that of an unguided
/// walk: the albedo.
SHARED Scattering scattering_at(Point p, uint from, vec3 back, vec3 w, bool dirac) MEMBER_CONST {
  Scattering s = zero_Scattering();
  s.broad = 1.0f;
  s.broad_behind = 1.0f;
  if (!is_layered(p)) {
    s.f = !dirac && same_side(p, back, w) ? p.color * INVERSE_PI : vec3(0.0f);
    s.onward_w = simple_pdf_w(p, back, w, dirac);
    s.behind_w = simple_pdf_w(p, w, back, dirac);
    s.survival_behind = simple_albedo(p);
    return s;
  }
  // Both directions in a loop: the surface code is inlined only once per kernel.
  for (uint i = 0u; i < 2u; ++i) {
    ScatterContext here = scatter_context_at(p, i == 0u ? back : w);
    Seen to = seen_from(p, i == 0u ? w : back);
    Layers layers = layers_between(p, here, to, dirac);
    OF_FLOAT(Odds) odds = coated_odds(p, here);
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
      s.survival_behind = largest(coated_albedo(p, here));
    }
  }
  if (scene_has_panes) s.survival_behind = s.survival_behind * reciprocal(opacity_of(p, w));
  s.survival_behind = held_albedo(s.survival_behind);
  return s;
}

#include "shaders/shared/language_end.h"
