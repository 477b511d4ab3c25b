// All lights of a scene as one: libcommon/scene/lights.h in floats. Light walks begin at them; rays
// of other walks hit them.
//
// Include after sky.h, in a scope that has what that needs, load_light_emitter(),
// load_light_lamp(), scene_has_sky and scene_has_lamps.

#include "shaders/shared/language.h"

SHARED bool is_surface(uint source) MEMBER_CONST {
  return source == SOURCE_FRONT || source == SOURCE_BOTH;
}
SHARED bool is_sky(uint source) MEMBER_CONST {
  return scene_has_sky && source == SOURCE_SKY;
}
SHARED bool is_two_sided(uint source) MEMBER_CONST {
  return source == SOURCE_BOTH;
}
/// Whether a ray can hit it; if not, it is found only by sampling lights.
SHARED bool source_met(uint source) MEMBER_CONST {
  return source < SOURCE_LAMPS;
}
SHARED bool source_at_infinity(uint source) MEMBER_CONST {
  if (is_sky(source)) return true;
  return scene_has_lamps && source >= SOURCE_LAMPS &&
         load_light_lamp(source - SOURCE_LAMPS).parallel != 0u;
}
/// The side that it shines to, at a point with unit normal `front`; 0: all.
SHARED vec3 source_facing(uint source, vec3 front) MEMBER_CONST {
  return source == SOURCE_FRONT ? front : vec3(0.0f, 0.0f, 0.0f);
}

/// Emission along unit w: radiance for a surface and the sky (passed in), intensity for a lamp,
/// irradiance for parallel light. Black if no light begins there.
SHARED vec3 source_radiance(uint source, vec3 front, vec3 emission, InSky in_sky,
                            vec3 w) MEMBER_CONST {
  if (is_sky(source)) return in_sky.radiance;
  if (source == SOURCE_BOTH || (source == SOURCE_FRONT && dot(front, w) > 0.0f)) return emission;
  if (!scene_has_lamps || source < SOURCE_LAMPS) return vec3(0.0f, 0.0f, 0.0f);
  return lamp_radiance(load_light_lamp(source - SOURCE_LAMPS), w);
}

/// Density of the direction in which a walk leaves [1/sr]; at infinity that of the line along w
/// [1/canonical area].
SHARED float emission_pdf_w(uint source, vec3 front, vec3 w) MEMBER_CONST {
  if (source == SOURCE_NONE) return 0.0f;
  float cosine = dot(front, w);
  if (source == SOURCE_FRONT) return max(cosine, 0.0f) * INVERSE_PI;
  if (source == SOURCE_BOTH) return abs(cosine) * (0.5f * INVERSE_PI);
  if (is_sky(source)) return reciprocal(light_settings.sky_extent);
  if (!scene_has_lamps) return 0.0f;
  return lamp_pdf_w(load_light_lamp(source - SOURCE_LAMPS), w);
}
/// |cos| / pdf_w for a direction w of emission.
SHARED float cos_per_pdf_w(uint source, vec3 w) MEMBER_CONST {
  if (source == SOURCE_FRONT) return 3.14159265f;
  if (source == SOURCE_BOTH) return 6.28318531f;
  if (is_sky(source)) return light_settings.sky_extent;
  if (!scene_has_lamps || source < SOURCE_LAMPS) return 0.0f;
  return lamp_per_pdf_w(load_light_lamp(source - SOURCE_LAMPS), w);
}

SHARED LightPlace no_light_place() MEMBER_CONST {
  vec3 none = vec3(0.0f);
  LightPlace place = {SOURCE_NONE, kNoTriangle, 0.0f, 0.0f, none, none, {none, 0.0f, 0.0f}, 0.0f};
  return place;
}

SHARED uint drawn_light(uint word) MEMBER_CONST {
  return drawn_entry(light_settings.first_begin, light_settings.first_guide, light_settings.entries,
                     word);
}
/// A point on an emitter or at a lamp.
SHARED LightPlace place_on_light(uint entry, float u, float v, float side) MEMBER_CONST {
  LightPlace place = no_light_place();
  if (entry < light_settings.emitters) {
    Emitter emitter = load_light_emitter(entry);
    uniform_triangle(u, v, place.b1, place.b2);
    place.source = emitter.source;
    place.triangle = emitter.triangle;
    place.position = emitter.p0 + emitter.e1 * place.b1 + emitter.e2 * place.b2;
    bool back = emitter.source == SOURCE_BOTH && side < 0.5f;
    place.normal = back ? -emitter.normal : emitter.normal;
    place.pdf = emitter.pdf_A;
  } else if (scene_has_lamps) {
    uint i = entry - light_settings.emitters;
    Lamp lamp = load_light_lamp(i);
    place.source = SOURCE_LAMPS + i;
    place.position = lamp.parallel != 0u ? lamp.direction : lamp.position;
    place.pdf = lamp.pdf_1;
  }
  return place;
}

SHARED bool is_sky_entry(uint entry) MEMBER_CONST {
  return scene_has_sky && entry == light_settings.emitters + light_settings.lamps;
}
/// For a word that chose the sky and a number in [0,1): 32 bits to choose within it, all equally
/// likely.
SHARED uint word_in_sky(uint word, float more) MEMBER_CONST {
  uint entry = light_settings.emitters + light_settings.lamps;
  word64 place = word64_of(0u, word - load_light_word(light_settings.first_begin + entry));
  // The fraction of the sky's words, as 32 bits and 32 fractional bits; `more` fills the space
  // between one word and the next.
  word64 spread = word64_of(light_settings.spread_high, light_settings.spread_low);
  word64 between = word64_of(0u, uint(more * 16777216.0f) << 8);
  word64 low = product64(between, word64_of(0u, light_settings.spread_low));
  word64 high = product64(between, word64_of(0u, light_settings.spread_high));
  word64 all = sum64(product64(place, spread), sum64(high, word64_of(0u, high_word(low))));
  return high_word(all);
}

/// Density of sample_light at any point of `triangle`, if that is a surface; `position` as in
/// LightPlace.
SHARED float light_pdf(uint source, uint triangle, vec3, InSky in_sky) MEMBER_CONST {
  if (is_surface(source))
    return uintBitsToFloat(load_light_word(light_settings.first_pdf_A + triangle));
  if (is_sky(source)) return light_settings.sky_pdf_1 * in_sky.start_w;
  if (!scene_has_lamps || source < SOURCE_LAMPS) return 0.0f;
  return load_light_lamp(source - SOURCE_LAMPS).pdf_1;
}

/// A point where a walk begins. Four numbers in [0,1): which light, where on it (u, v), and on
/// which side.
SHARED LightPlace sample_light(float pick, float u, float v, float side) MEMBER_CONST {
  LightPlace place = no_light_place();
  if (light_settings.entries == 0u) return place;
  uint word = pick_word(pick, side);
  uint entry = drawn_light(word);
  if (!is_sky_entry(entry)) return place_on_light(entry, u, v, side);
  if (scene_has_sky) {
    SkyPlace drawn = drawn_in_sky(light_settings.start, word_in_sky(word, side), u, v);
    place.source = SOURCE_SKY;
    place.position = -drawn.towards;
    place.in_sky = look_in_sky(drawn);
    place.pdf = light_pdf(SOURCE_SKY, kNoTriangle, place.position, place.in_sky);
  }
  return place;
}

/// A ray of light from that point: cosine-distributed on a surface, by lamp_pdf_w() from a lamp,
/// from a disc outside the scene if infinitely far.
SHARED void leave_light(LightPlace place, float u, float v, OUT(vec3) origin,
                        OUT(vec3) direction) MEMBER_CONST {
  origin = place.position;
  direction = place.position;
  if (is_surface(place.source)) {
    direction = normalized(cosine_hemisphere(place.normal, u, v));
    return;
  }
  if (source_at_infinity(place.source))
    origin = before_the_disc(place.position, light_settings.radius, u, v);
  else if (scene_has_lamps && place.source >= SOURCE_LAMPS)
    direction = leave_lamp(load_light_lamp(place.source - SOURCE_LAMPS), u, v);
}

#include "shaders/shared/language_end.h"
