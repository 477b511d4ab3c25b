// Emission of a lamp, a light without extent: a point light, even or with a profile, a spot, or
// parallel light. The smooth edge of a spot is the one that KHR_lights_punctual recommends, without
// its lower bound of 0.001 on the difference of the cosines, which narrow spots undercut.
//
// Include in a scope that has load_light_word(), after lights_layout.h, which describes a Lamp. C++
// also uses it in doubles.

#include "shaders/shared/language.h"

/// 1 - cos of the angle between a lamp's axis and unit w.
SHARED REAL versine_from_axis(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  VEC3 d = w - lamp.direction;
  return 0.5f * dot(d, d);
}

SHARED REAL profile_number(uint i) MEMBER_CONST {
  return REAL(uintBitsToFloat(load_light_word(i)));
}
/// Index of the interval, out of `count` - 1 between ascending numbers from `first` on, that
/// contains x.
SHARED uint profile_interval(uint first, uint count, REAL x) MEMBER_CONST {
  uint low = 0u;
  uint high = count - 1u;
  while (low + 1u < high) {
    uint middle = (low + high) / 2u;
    if (profile_number(first + middle) > x)
      high = middle;
    else
      low = middle;
  }
  return low;
}
/// Fraction of the way from one number to the next at x.
SHARED REAL profile_share(uint at, REAL x) MEMBER_CONST {
  REAL a = profile_number(at);
  return min(max((x - a) * reciprocal(profile_number(at + 1u) - a), 0.0f), 1.0f);
}
SHARED REAL profile_in_column(uint at, REAL share) MEMBER_CONST {
  REAL a = profile_number(at);
  return a + (profile_number(at + 1u) - a) * share;
}
/// Intensity along unit w relative to the maximum, for a lamp with a profile (tdpt::LightProfile).
SHARED REAL profile_at(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  uint rows = load_light_word(lamp.profile);
  uint columns = load_light_word(lamp.profile + 1u);
  uint first_row = lamp.profile + 2u;
  uint first_column = first_row + rows;
  REAL x = dot(w, lamp.across);
  REAL y = dot(w, cross(lamp.across, lamp.direction));
  REAL vertical = turns_of(root(x * x + y * y), dot(w, lamp.direction));
  if (vertical > profile_number(first_column - 1u)) return REAL(0.0f);
  if (vertical < profile_number(first_row)) return REAL(0.0f);
  uint row = profile_interval(first_row, rows, vertical);
  REAL share = profile_share(first_row + row, vertical);
  uint value = first_column + columns + row;
  if (columns == 1u) return profile_in_column(value, share);
  REAL horizontal = turns_of(y, x);
  if (horizontal < profile_number(first_column)) horizontal = horizontal + 1.0f;
  if (horizontal > profile_number(first_column + columns - 1u)) return REAL(0.0f);
  uint column = profile_interval(first_column, columns, horizontal);
  value = value + column * rows;
  REAL here = profile_in_column(value, share);
  REAL next = profile_in_column(value + rows, share);
  return here + (next - here) * profile_share(first_column + column, horizontal);
}

/// Along unit w: intensity; for parallel light: irradiance.
SHARED VEC3 lamp_radiance(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  REAL inside = (lamp.edge - versine_from_axis(lamp, w)) * lamp.per_edge;
  REAL share = min(max(inside, 0.0f), 1.0f);
  REAL of_greatest = share * share;
  if (lamp.profile != kNoProfile) of_greatest = of_greatest * profile_at(lamp, w);
  return lamp.intensity * of_greatest;
}
/// Where the rings of a profile begin, one between each of its rows and the next.
SHARED uint first_ring(IN(Lamp) lamp) MEMBER_CONST {
  uint rows = load_light_word(lamp.profile);
  uint columns = load_light_word(lamp.profile + 1u);
  return lamp.profile + 2u + rows + columns + rows * columns;
}
/// Density of the direction w in which a walk leaves [1/sr], uniform within the cone, or within
/// each ring of a profile; for parallel light that of the line along w [1/canonical area].
SHARED REAL lamp_pdf_w(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  REAL h = versine_from_axis(lamp, w);
  if (h > lamp.edge) return REAL(0.0f);
  if (lamp.profile == kNoProfile) return lamp.pdf_w;
  uint edges = load_light_word(lamp.profile);
  uint rings = first_ring(lamp);
  return profile_number(rings + 2u * edges + profile_interval(rings, edges, h));
}
/// cos / pdf_w, which is 1 / pdf_w for a lamp; 0 where no walk leaves.
SHARED REAL lamp_per_pdf_w(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  if (lamp.profile == kNoProfile) return lamp.extent;
  REAL pdf = lamp_pdf_w(lamp, w);
  return pdf > 0.0f ? reciprocal(pdf) : REAL(0.0f);
}
/// Samples that direction, for a lamp that is not infinitely far.
SHARED VEC3 leave_lamp(IN(Lamp) lamp, REAL u, REAL v) MEMBER_CONST {
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL h = v * lamp.cone;
  if (lamp.profile != kNoProfile) {
    uint edges = load_light_word(lamp.profile);
    uint rings = first_ring(lamp);
    uint ring = profile_interval(rings + edges, edges, v);
    REAL inner = profile_number(rings + ring);
    h = inner +
        (profile_number(rings + ring + 1u) - inner) * profile_share(rings + edges + ring, v);
  }
  REAL r = root(h * (2.0f - h));
  VEC3 local = VEC3(r * cosine, r * sine, 1.0f - h);
  return normalized(to_world(onb_about(lamp.direction), local));
}
/// Origin of a ray of parallel light along unit w that passes a ball around the scene's origin: on
/// a disc perpendicular to w.
SHARED VEC3 before_the_disc(VEC3 w, REAL radius, REAL u, REAL v) MEMBER_CONST {
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL r = radius * root(v);
  VEC3 local = VEC3(r * cosine, r * sine, -2.0f * radius);
  return to_world(onb_about(w), local);
}

#include "shaders/shared/language_end.h"
