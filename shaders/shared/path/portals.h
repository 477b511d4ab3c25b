// Draws segments, and directions of walks, through the portals, and tells the density with which
// any edge of a path would have been drawn so: tools/tdpt-render/portals/portals.h in floats. The
// method and all symbols are told there, margins in portal_layout.h.
//
// Where floats differ. Crossings are found from the nearer end of an edge, and distances to a plane
// are heights over cosines, so that nothing grows with the edge's smallness. Whether an edge has
// ends on either side of a plane is asked of their heights everywhere, so that what was drawn and
// spans a facet crosses it; which of a facet's triangles it crosses, `Drawn` says where that is
// known.
//
// Read within a scope that has
//   load_portal_facet(i) and all others of TABLES_OF_PORTALS [tables.h]
//   GuideParameters guiding
//   scene_has_portals, portals_have_pairs

#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/rng.h"

#include "shaders/shared/language.h"

/// Of p over the facet's plane; < 0 on the light's side.
SHARED float portal_height(PortalFacet f, vec3 p) MEMBER_CONST {
  return dot(f.normal, p - f.centre);
}

/// Whether a point of its plane lies in the polygon and `inside` (barycentric) off its borders.
SHARED bool polygon_holds(PortalPolygon p, vec3 at, float inside) MEMBER_CONST {
  vec3 d = at - p.p0;
  float b1 = dot(p.grad1, d);
  float b2 = dot(p.grad2, d);
  return b1 >= inside && b2 >= inside && b1 + b2 <= 1.0f - inside;
}

/// How many triangles of the facet are crossed at `at`.
SHARED int portal_crossed(PortalFacet f, vec3 at, Drawn drawn) MEMBER_CONST {
  int first = int(f.first);
  int end = int(f.end);
  bool polygon_here = drawn.polygon >= first && drawn.polygon < end;
  bool second_here = drawn.second >= first && drawn.second < end;
  int here = polygon_here ? drawn.polygon : second_here ? drawn.second : -1;
  vec3 off = at - f.centre;
  bool away = here < 0 && dot(off, off) > f.reach2;
  end = away ? first : end;
  float inside = here < 0 ? 0.0f : f.border;
  int n = 0;
  for (int i = first; i < end; ++i) {
    PortalPolygon polygon = load_portal_polygon(uint(i));
    n += i == here || polygon_holds(polygon, at, inside) ? 1 : 0;
  }
  return n;
}

/// Where the line through `from` and `to` passes a facet. `beyond`: one of them may be on the wrong
/// side of it; `d`: to - from; `per_length`: 1 / |d|.
SHARED PortalPassage portal_passage(PortalFacet f, vec3 from, vec3 to, vec3 d, float per_length,
                                    bool beyond, Drawn drawn) MEMBER_CONST {
  PortalPassage p;
  p.before = portal_height(f, from);
  p.after = portal_height(f, to);
  float slope = dot(f.normal, d);
  p.cosine = slope * per_length;
  p.triangles = 0;
  bool begins = p.before < -kPortalMargin;
  bool ends = p.after > kPortalMargin;
  bool nearer = abs(p.before) < abs(p.after);
  float height = nearer ? p.before : p.after;
  bool passes = (begins && ends) || (beyond && (begins || ends));
  if (passes && abs(height) < kPortalReach * p.cosine) {
    vec3 at = (nearer ? from : to) - d * (height * reciprocal(slope));
    p.triangles = portal_crossed(f, at, drawn);
  }
  return p;
}

/// The part of D of the pairs that light passes facet k first of.
SHARED float portal_density_of_pairs(uint k, vec3 from, vec3 to, vec3 d, float per_length,
                                     Drawn drawn) MEMBER_CONST {
  float all = 0.0f;
  PortalFacet facet = load_portal_facet(k);
  PortalPassage of_f = portal_passage(facet, from, to, d, per_length, false, drawn);
  float per_f = of_f.triangles > 0 ? reciprocal(of_f.cosine) : 0.0f;
  uint end = of_f.triangles > 0 ? facet.end_pair : 0u;
  for (uint i = facet.first_pair; i < end; ++i) {
    PortalPair pair = load_portal_pair(i);
    PortalPassage of_g =
        portal_passage(load_portal_facet(pair.second), from, to, d, per_length, false, drawn);
    int ways = of_f.triangles * of_g.triangles;  // choices of triangles that give this line
    if (ways > 0) {
      float per_g = reciprocal(of_g.cosine);
      float apart = of_g.before * per_g - of_f.before * per_f;
      all += float(ways) * pair.pdf * (apart * apart) * (per_f * per_g);
    }
  }
  return all;
}
/// The part of D that pairs have. `crossed`: those of the first 32 facets that are, a bit each: a
/// group of lanes goes round as often as the one of them that crosses most.
SHARED float portal_pair_density(uint crossed, vec3 from, vec3 to, vec3 d, float per_length,
                                 Drawn drawn) MEMBER_CONST {
  float all = 0.0f;
  uint rest = crossed;
  while (rest != 0u) {
    uint k = uint(findLSB(rest));
    rest = rest & (rest - 1u);
    all += portal_density_of_pairs(k, from, to, d, per_length, drawn);
  }
  for (uint k = 32u; k < guiding.facets; ++k)
    all += portal_density_of_pairs(k, from, to, d, per_length, drawn);
  return all;
}

/// 1 / |d|; 0: no line to speak of.
SHARED float portal_per_length(vec3 d) MEMBER_CONST {
  float d2 = dot(d, d);
  return d2 > 1e-36f ? inverse_root(d2) : 0.0f;
}

/// D of [eq. 4] of the segment `from` (light's side) -> `to` (camera's side); 0 when it crosses no
/// triangle along its normal.
SHARED float portal_density(vec3 from, vec3 to, Drawn drawn) MEMBER_CONST {
  if (!scene_has_portals) return 0.0f;
  float sum = 0.0f;
  uint crossed = 0u;
  vec3 d = to - from;
  float per_length = portal_per_length(d);
  if (per_length == 0.0f) return 0.0f;
  for (uint f = 0u; f < guiding.facets; ++f) {
    PortalFacet facet = load_portal_facet(f);
    PortalPassage p = portal_passage(facet, from, to, d, per_length, false, drawn);
    sum += float(p.triangles) * facet.density;
    crossed |= p.triangles > 0 && f < 32u ? 1u << (f & 31u) : 0u;
  }
  if (portals_have_pairs) sum += portal_pair_density(crossed, from, to, d, per_length, drawn);
  return sum;
}

/// w_F(v), more than 0 off the plane.
SHARED float portal_weight(PortalFacet f, vec3 v) MEMBER_CONST {
  if (guiding.facets == 1u) return 1.0f;
  vec3 d = f.centre - v;
  float d2 = dot(d, d);
  // Seen at a grazing angle a facet keeps a tenth of the weight.
  float height = abs(dot(f.normal, d));
  if (height * height < 0.01f * d2) height = 0.1f * root(d2);
  float area = f.area;
  float per_reach = inverse_root(d2 + area * 0.318309886f);
  return area * height * (per_reach * per_reach * per_reach);
}

SHARED Crossing portal_crossing(vec3 from, vec3 to, Drawn drawn) MEMBER_CONST {
  Crossing c = no_crossing();
  if (!scene_has_portals) return c;
  uint crossed = 0u;
  vec3 d = to - from;
  float per_length = portal_per_length(d);
  if (per_length == 0.0f) return c;
  for (uint f = 0u; f < guiding.facets; ++f) {
    PortalFacet facet = load_portal_facet(f);
    PortalPassage p = portal_passage(facet, from, to, d, per_length, true, drawn);
    if (p.triangles == 0) continue;
    bool begins = p.before < -kPortalMargin;
    bool ends = p.after > kPortalMargin;
    float n = float(p.triangles);
    if (begins && ends) c.density += n * facet.density;
    crossed |= begins && ends && f < 32u ? 1u << (f & 31u) : 0u;
    // d^2 / (cos A), where d is the height over the cosine.
    float per_cosine = reciprocal(p.cosine);
    float per_area = n * facet.per_area * (per_cosine * per_cosine * per_cosine);
    if (begins) c.from_light += portal_weight(facet, from) * (p.before * p.before) * per_area;
    if (ends) c.from_camera += portal_weight(facet, to) * (p.after * p.after) * per_area;
  }
  if (portals_have_pairs) c.density += portal_pair_density(crossed, from, to, d, per_length, drawn);
  return c;
}

/// Whether x_l, x_c lie on either side of all that the segment was drawn through: one that was
/// drawn through a pair and is stopped between them is of no use.
SHARED bool segment_spans(Drawn drawn, vec3 x_l, vec3 x_c) MEMBER_CONST {
  for (int i = 0; i < 2; ++i) {
    int polygon = i == 0 ? drawn.polygon : drawn.second;
    if (polygon < 0) continue;
    PortalFacet f = load_portal_facet(load_portal_polygon(uint(polygon)).facet);
    if (!(portal_height(f, x_l) < -kPortalMargin && portal_height(f, x_c) > kPortalMargin))
      return false;
  }
  return true;
}

/// The polygon of first .. end-1 that u falls on, by its share of the area of all or of its facet.
SHARED uint polygon_picked(uint first, uint end, bool of_all, float u) MEMBER_CONST {
  uint low = first;
  uint high = end - 1u;
  while (low < high) {
    uint middle = (low + high) >> 1u;
    float up_to =
        of_all ? load_portal_polygon(middle).end_of_all : load_portal_polygon(middle).end_of_facet;
    if (u < up_to)
      high = middle;
    else
      low = middle + 1u;
  }
  return low;
}

SHARED vec3 point_in_polygon(uint i, float u, float v) MEMBER_CONST {
  float b1 = 0.0f;
  float b2 = 0.0f;
  uniform_triangle(u, v, b1, b2);
  PortalPolygon p = load_portal_polygon(i);
  return p.p0 + (p.e1 * b1 + p.e2 * b2);
}

SHARED vec3 point_on_facet(uint f, float pick, float u, float v, OUT(int) polygon) MEMBER_CONST {
  PortalFacet facet = load_portal_facet(f);
  uint i = polygon_picked(facet.first, facet.end, false, pick);
  polygon = int(i);
  return point_in_polygon(i, u, v);
}

/// Whether a corner of the facet is on the side of v that `facing` looks to (0: either).
SHARED bool portal_above(PortalFacet f, vec3 v, vec3 facing) MEMBER_CONST {
  // Where the middle is, a corner is: but for rounding.
  bool above = is_zero(facing) || dot(facing, f.centre - v) > kPortalMargin;
  uint end = f.end_corner;
  for (uint i = f.first_corner; i < end && !above; ++i)
    above = dot(facing, load_portal_corner(i).at - v) > 0.0f;
  return above;
}

/// W at `v` of walks from either end: of the facets that have v on the side that such walks begin
/// on, and a corner on the side of v that `facing` looks to (0: either). 0: nothing to aim at.
SHARED void portal_aims(vec3 v, vec3 facing, OUT(float) from_light,
                        OUT(float) from_camera) MEMBER_CONST {
  float of_light = 0.0f;
  float of_camera = 0.0f;
  uint facets = scene_has_portals ? guiding.facets : 0u;
  for (uint f = 0u; f < facets; ++f) {
    PortalFacet facet = load_portal_facet(f);
    float height = portal_height(facet, v);
    float weight = portal_above(facet, v, facing) ? portal_weight(facet, v) : 0.0f;
    of_light += height < -kPortalMargin ? weight : 0.0f;
    of_camera += height > kPortalMargin ? weight : 0.0f;
  }
  from_light = of_light;
  from_camera = of_camera;
}
/// The same of walks from one end.
SHARED float portal_aims(vec3 v, vec3 facing, uint from) MEMBER_CONST {
  float from_light = 0.0f;
  float from_camera = 0.0f;
  portal_aims(v, facing, from_light, from_camera);
  return from == FROM_LIGHT ? from_light : from_camera;
}

/// Unit direction from `v` towards a facet; W must be that of portal_aims() for the same arguments,
/// and more than 0. `u`, `v_`: place on the facet; `pick`: its choice. Returns the triangle aimed
/// at.
SHARED int portal_aim(vec3 v, vec3 facing, uint from, float W, float u, float v_, float pick,
                      OUT(vec3) w) MEMBER_CONST {
  float rest = pick * W;
  uint chosen = 0u;
  float weight = 1.0f;
  for (uint f = 0u; f < guiding.facets; ++f) {
    PortalFacet facet = load_portal_facet(f);
    float height = portal_height(facet, v);
    if (!((from == FROM_LIGHT ? -height : height) > kPortalMargin)) continue;
    if (!portal_above(facet, v, facing)) continue;
    chosen = f;
    weight = portal_weight(facet, v);
    rest -= weight;
    if (rest < 0.0f) break;
  }
  // What chose the facet within W chooses the triangle within the facet.
  float within = min(max(1.0f + rest * reciprocal(weight), 0.0f), 1.0f);
  int polygon = 0;
  vec3 at = point_on_facet(chosen, within, u, v_, polygon);
  w = normalized(at - v);
  return polygon;
}

/// A_F cos_F of parallel light along unit d; 0 edge on and from the front.
SHARED float portal_across(PortalFacet f, vec3 d) MEMBER_CONST {
  float cosine = dot(f.normal, d);
  return cosine > kPortalEdgeOn ? f.area * cosine : 0.0f;
}

/// W of parallel light, which travels along unit `d`.
SHARED float portal_aims_along(vec3 d) MEMBER_CONST {
  float sum = 0.0f;
  if (!scene_has_portals) return sum;
  for (uint f = 0u; f < guiding.facets; ++f) sum += portal_across(load_portal_facet(f), d);
  return sum;
}

/// The point that a line of it goes through; returns the triangle it lies on.
SHARED int portal_aim_along(vec3 d, float W, float u, float v, float pick,
                            OUT(vec3) at) MEMBER_CONST {
  float rest = pick * W;
  uint chosen = 0u;
  float weight = 1.0f;
  for (uint f = 0u; f < guiding.facets; ++f) {
    float across = portal_across(load_portal_facet(f), d);
    if (!(across > 0.0f)) continue;
    chosen = f;
    weight = across;
    rest -= weight;
    if (rest < 0.0f) break;
  }
  float within = min(max(1.0f + rest * reciprocal(weight), 0.0f), 1.0f);
  int polygon = 0;
  at = point_on_facet(chosen, within, u, v, polygon);
  return polygon;
}

/// How many triangles the line along d that arrives at `to` crosses.
SHARED int crossed_along(vec3 d, vec3 to, Drawn drawn) MEMBER_CONST {
  int n = 0;
  for (uint f = 0u; f < guiding.facets; ++f) {
    PortalFacet facet = load_portal_facet(f);
    float cosine = dot(facet.normal, d);
    if (!(cosine > kPortalEdgeOn)) continue;
    float t = portal_height(facet, to) * reciprocal(cosine);
    n += portal_crossed(facet, to - d * t, drawn);
  }
  return n;
}

/// A segment: place on a triangle and direction, two numbers each, and three for their choice.
/// There must be portals.
SHARED SegmentDraw sample_segment(float u0, float u1, float u2, float u3, float u4, float u5,
                                  float u6) MEMBER_CONST {
  SegmentDraw s;
  if (portals_have_pairs && u5 < guiding.pair_share) {
    float u = u5 * guiding.per_pair_share;
    uint low = 0u;
    uint high = guiding.pairs - 1u;
    while (low < high) {
      uint middle = (low + high) >> 1u;
      if (u < load_portal_pair(middle).end)
        high = middle;
      else
        low = middle + 1u;
    }
    int first = 0;
    int second = 0;
    PortalPair pair = load_portal_pair(low);
    s.position = point_on_facet(pair.first, u4, u0, u1, first);
    vec3 to = point_on_facet(pair.second, u6, u2, u3, second);
    s.direction = normalized(to - s.position);
    s.drawn = drawn_through(first, second);
    s.portal = load_portal_polygon(first).portal;
    return s;
  }
  uint i = polygon_picked(0u, guiding.polygons, true, u4);
  s.position = point_in_polygon(i, u0, u1);
  s.direction =
      normalized(cosine_hemisphere(load_portal_facet(load_portal_polygon(i).facet).normal, u2, u3));
  s.drawn = drawn_through(int(i));
  s.portal = load_portal_polygon(i).portal;
  return s;
}

/// Where both rays of a segment begin: behind the portal by half the margin, so that what lies in
/// its plane, a pane as like as not, is met by one of them alone.
SHARED vec3 segment_start(SegmentDraw s) MEMBER_CONST {
  uint f = load_portal_polygon(s.drawn.polygon).facet;
  return s.position - load_portal_facet(f).normal * (0.5f * kPortalMargin);
}

#include "shaders/shared/language_end.h"
