// Turns a place on a face into a point of a path: place_on_surface() of
// tools/tdpt-render/path/sample/world.cpp in floats. Textures, vertex colours and vertex normals
// are evaluated as in libcommon/scene/texture.cpp.
//
// Texture coordinates are computed relative to the first corner's, without its whole images, so
// that those far from 0 lose as little precision as possible.
//
// Include in a scope that has load_x(i) of TABLES_OF_SURFACES [tables.h], scene_has_textures,
// scene_has_normals and scene_has_colours, after bsdf.h and mapped.h.

#include "shaders/shared/language.h"

/// A point on a face.
struct SurfacePlace {
  uint triangle;
  float b1;
  float b2;
};

SHARED float interpolated(float a, float b, float c, SurfacePlace at) MEMBER_CONST {
  return a + (b - a) * at.b1 + (c - a) * at.b2;
}
SHARED vec3 interpolated(vec3 a, vec3 b, vec3 c, SurfacePlace at) MEMBER_CONST {
  return a + (b - a) * at.b1 + (c - a) * at.b2;
}

SHARED float linear_byte(uint word, uint shift, bool srgb) MEMBER_CONST {
  uint byte = (word >> shift) & 255u;
  return srgb ? load_surface_curve(kLinearOfSrgb + byte) : share_of_byte(byte);
}
SHARED Texel texel_of(uint word, bool srgb) MEMBER_CONST {
  Texel t;
  t.rgb =
      vec3(linear_byte(word, 0u, srgb), linear_byte(word, 8u, srgb), linear_byte(word, 16u, srgb));
  t.alpha = share_of_byte(word >> 24);
  return t;
}

/// Whole images before the first corner's coordinate.
SHARED float images_before(float u, bool clamp_to_edge) MEMBER_CONST {
  return clamp_to_edge ? 0.0f : whole_images(texture_coordinate(u));
}

SHARED TexelSpan span_of(SurfaceMap map, SurfacePlace at) MEMBER_CONST {
  FaceCorners corners = load_face_corners(at.triangle);
  CornerAttributes a = load_corner_attributes(corners.a);
  CornerAttributes b = load_corner_attributes(corners.b);
  CornerAttributes c = load_corner_attributes(corners.c);
  bool second = map.uv_set != 0u;
  float u0 = second ? a.u1 : a.u0;
  float v0 = second ? a.v1 : a.v0;
  float du = ((second ? b.u1 : b.u0) - u0) * at.b1 + ((second ? c.u1 : c.u0) - u0) * at.b2;
  float dv = ((second ? b.v1 : b.v0) - v0) * at.b1 + ((second ? c.v1 : c.v0) - v0) * at.b2;
  float first_u = map.u_of_u * u0 + map.u_of_v * v0 + map.u_shift;
  float first_v = map.v_of_u * u0 + map.v_of_v * v0 + map.v_shift;
  float u = (first_u - images_before(first_u, (map.grid.how & TEXELS_CLAMP_U) != 0u)) +
            (map.u_of_u * du + map.u_of_v * dv);
  float v = (first_v - images_before(first_v, (map.grid.how & TEXELS_CLAMP_V) != 0u)) +
            (map.v_of_u * du + map.v_of_v * dv);
  return texel_span(map.grid, texture_coordinate(u), texture_coordinate(v));
}

/// Linear, each in [0,1].
SHARED Texel lookup(uint map, SurfacePlace at) MEMBER_CONST {
  Texel t;
  bool srgb = (load_texture_map(map).grid.how & TEXELS_SRGB) != 0u;
  TexelSpan span = span_of(load_texture_map(map), at);
  Texel t00 = texel_of(load_texel_word(span.texel00), srgb);
  Texel t10 = texel_of(load_texel_word(span.texel10), srgb);
  Texel t01 = texel_of(load_texel_word(span.texel01), srgb);
  Texel t11 = texel_of(load_texel_word(span.texel11), srgb);
  vec3 low = t00.rgb + (t10.rgb - t00.rgb) * span.x;
  vec3 high = t01.rgb + (t11.rgb - t01.rgb) * span.x;
  t.rgb = low + (high - low) * span.y;
  t.alpha = bilinear(span, t00.alpha, t10.alpha, t01.alpha, t11.alpha);
  return t;
}

/// The material at a point: textures and vertex colours multiplied into its factors, each component
/// of the base colour in [0,1].
SHARED SurfaceMaterial material_at(uint material, SurfacePlace at) MEMBER_CONST {
  SurfaceMaterial m = load_material(material);
  if ((m.flags & MATERIAL_PLAIN) != 0u) return m;
  if (scene_has_textures) {
    for (uint k = 0u; k < MAPS_OF_FACTORS; ++k) {
      uint map = load_material_map(MAPS_OF_MATERIAL * material + k);
      if (map != kNoMap) multiply(m, k, lookup(map, at));
    }
  }
  vec3 c = m.base_color;
  if (scene_has_colours) {
    FaceCorners corners = load_face_corners(at.triangle);
    c = c * interpolated(load_corner_attributes(corners.a).color,
                         load_corner_attributes(corners.b).color,
                         load_corner_attributes(corners.c).color, at);
  }
  m.base_color =
      vec3(min(max(c.x, 0.0f), 1.0f), min(max(c.y, 0.0f), 1.0f), min(max(c.z, 0.0f), 1.0f));
  return m;
}

/// Directions +X (right) and +Y (up) of a normal map, from the corners' positions and texture
/// coordinates: along dP/du, and against dP/dv. 0 if there is no frame.
SHARED void derived_tangents(SurfaceMap map, Face face, FaceCorners corners, OUT(vec3) x,
                             OUT(vec3) y) MEMBER_CONST {
  CornerAttributes a = load_corner_attributes(corners.a);
  CornerAttributes b = load_corner_attributes(corners.b);
  CornerAttributes c = load_corner_attributes(corners.c);
  bool second = map.uv_set != 0u;
  float du1 = second ? b.u1 - a.u1 : b.u0 - a.u0;
  float dv1 = second ? b.v1 - a.v1 : b.v0 - a.v0;
  float du2 = second ? c.u1 - a.u1 : c.u0 - a.u0;
  float dv2 = second ? c.v1 - a.v1 : c.v0 - a.v0;
  float m0 = map.u_of_u * du1 + map.u_of_v * dv1;
  float m1 = map.v_of_u * du1 + map.v_of_v * dv1;
  float m2 = map.u_of_u * du2 + map.u_of_v * dv2;
  float m3 = map.v_of_u * du2 + map.v_of_v * dv2;
  x = vec3(0.0f);
  y = vec3(0.0f);
  float most = max(max(abs(m0), abs(m1)), max(abs(m2), abs(m3)));
  if (!(most > 1e-30f && most < 1e30f)) return;
  float scale = reciprocal(most);
  m0 = m0 * scale;
  m1 = m1 * scale;
  m2 = m2 * scale;
  m3 = m3 * scale;
  float determinant = m0 * m3 - m1 * m2;
  if (determinant == 0.0f) return;
  float sign = either_sign(determinant);
  x = (face.e1 * m3 - face.e2 * m1) * sign;
  y = (face.e1 * m2 - face.e2 * m0) * sign;
}

/// `n` bent by the normal map.
SHARED vec3 bent_normal(uint map, float scale, Face face, SurfacePlace at, vec3 n) MEMBER_CONST {
  FaceCorners corners = load_face_corners(at.triangle);
  CornerAttributes a = load_corner_attributes(corners.a);
  vec3 x = across(interpolated(a.tangent, load_corner_attributes(corners.b).tangent,
                               load_corner_attributes(corners.c).tangent, at),
                  n);
  float hand = either_sign(a.handedness);
  if (is_zero(x)) {
    vec3 u;
    vec3 v;
    derived_tangents(load_texture_map(map), face, corners, u, v);
    x = across(u, n);
    hand = either_sign(dot(cross(n, brought_near_1(u)), brought_near_1(v)));
  }
  if (is_zero(x)) return n;
  return bent_by(lookup(map, at), scale, x, hand, n);
}

/// Unit shading normal of the front side: interpolated from the corners, bent by a map.
SHARED vec3 shading_normal_at(Face face, uint map, float scale, SurfacePlace at) MEMBER_CONST {
  vec3 n = face.normal;
  bool is_smooth = scene_has_normals && face.smoothed != 0u;
  if (is_smooth) {
    FaceCorners corners = load_face_corners(at.triangle);
    vec3 mean = interpolated(load_corner_attributes(corners.a).normal,
                             load_corner_attributes(corners.b).normal,
                             load_corner_attributes(corners.c).normal, at);
    float l2 = dot(mean, mean);
    if (l2 > 1e-12f) n = mean * (face.smoothed == 2u ? -inverse_root(l2) : inverse_root(l2));
  }
  bool is_bent = scene_has_textures && map != kNoMap;
  if (!is_smooth && !is_bent) return face.normal;
  if (is_bent) n = bent_normal(map, scale, face, at, in_front(n, face.normal));
  return in_front(n, face.normal);
}

SHARED void add_layers(Face face, SurfaceMaterial m, SurfacePlace at, INOUT(Point) p) MEMBER_CONST {
  p.simple = false;
  bool bent_coat =
      scene_has_coats && m.coat > 0.0f && scene_has_textures && (m.flags & MATERIAL_BENDS) != 0u;
  vec3 coat_normal = face.normal;
  for (uint k = 0u; k < (bent_coat ? 2u : 1u); ++k) {
    vec3 n = shading_normal_at(face,
                               load_material_map(MAPS_OF_MATERIAL * face.material + MAP_NORMAL + k),
                               k == 0u ? m.normal_scale : m.coat_normal_scale, at);
    p.shading = k == 0u ? n : p.shading;
    coat_normal = n;
  }
  if ((m.flags & MATERIAL_PLAIN) == 0u) put_material(m, bent_coat, coat_normal, p);
}

/// A diffuse point that does not emit.
SHARED Point simple_point(vec3 position, vec3 normal, uint triangle, uint material,
                          vec3 color) MEMBER_CONST {
  InSky in_sky = {vec3(0.0f), 0.0f, 0.0f};
  Point p = {position, normal, normal, triangle,   material, SOURCE_NONE,
             true,     true,   color,  vec3(0.0f), in_sky,   diffuse_bsdf(color)};
  return p;
}

/// Sets `p` to the point of a face at barycentrics b1, b2 of its second and third corner.
SHARED void place_on_surface(uint triangle, float b1, float b2, OUT(Point) p) MEMBER_CONST {
  SurfacePlace at = {triangle, b1, b2};
  Face face = load_face(triangle);
  SurfaceMaterial m = material_at(face.material, at);
  vec3 position = face.p0 + face.e1 * b1 + face.e2 * b2;
  p = simple_point(position, face.normal, triangle, face.material, m.base_color);
  bool is_plain = (m.flags & MATERIAL_PLAIN) != 0u;
  bool is_flat = !scene_has_normals || face.smoothed == 0u;
  if (scene_has_layers && !(is_plain && is_flat)) add_layers(face, m, at, p);
  if ((m.flags & MATERIAL_EMITS) == 0u) return;
  p.emission = m.emission;
  if (!is_zero(p.emission))
    p.source = (m.flags & MATERIAL_DOUBLE_SIDED) != 0u ? SOURCE_BOTH : SOURCE_FRONT;
}

/// Probability that a pane stops a ray along `w`, of any length; 1 for all other surfaces.
SHARED float opacity_at(uint triangle, vec3 w) MEMBER_CONST {
  if (!scene_has_panes) return 1.0f;
  SurfaceMaterial m = load_material(load_face(triangle).material);
  if (!(m.pane_share > 0.0f)) return 1.0f;
  vec3 unit = normalized(brought_near_1(w));
  OF_FLOAT(FresnelCurve) f = schlick_curve(min(abs(dot(load_face(triangle).normal, unit)), 1.0f));
  return 1.0f - m.pane_share * ((1.0f - m.pane_f90) + (m.pane_f90 - m.pane_f0) * f.rest);
}

SHARED float opacity_of(Point p, vec3 w) MEMBER_CONST {
  return max(opacity_at(p.triangle, w), 1e-6f);
}
SHARED bool is_in_sky(Point p) MEMBER_CONST {
  return p.source == SOURCE_SKY;
}
SHARED vec3 absorption_of(Point p) MEMBER_CONST {
  SurfaceMaterial m = load_material(p.material);
  return (m.flags & MATERIAL_ABSORBS) != 0u ? m.absorption : vec3(0.0f);
}

#include "shaders/shared/language_end.h"
