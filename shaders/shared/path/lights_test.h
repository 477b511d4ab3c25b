// Test only: results of the functions on lights for random numbers, as words, to compare a device
// with its scalar build. Include after next_event.h, in a scope that also has shaded_places[].

#include "shaders/shared/language.h"

SHARED Point shaded_point(Shaded shaded) MEMBER_CONST {
  Point p;
  p.position = shaded.position;
  p.normal = shaded.normal;
  p.shading = shaded.shading;
  p.simple = shaded.simple != 0u;
  p.connectible = true;
  p.triangle = 0u;
  return p;
}

SHARED void add_word(INOUT(LightWords) drawn, float value) MEMBER_CONST {
  drawn.words[drawn.count] = floatBitsToUint(value);
  drawn.count += 1u;
}
SHARED void add_vec3(INOUT(LightWords) drawn, vec3 v) MEMBER_CONST {
  add_word(drawn, v.x);
  add_word(drawn, v.y);
  add_word(drawn, v.z);
}
SHARED void add_in_sky(INOUT(LightWords) drawn, InSky in_sky) MEMBER_CONST {
  add_vec3(drawn, in_sky.radiance);
  add_word(drawn, in_sky.plain_w);
  add_word(drawn, in_sky.start_w);
}
SHARED void add_place(INOUT(LightWords) drawn, LightPlace place) MEMBER_CONST {
  add_word(drawn, float(place.source));
  add_word(drawn, float(place.triangle & 0xFFFFu));
  add_word(drawn, place.b1);
  add_word(drawn, place.b2);
  add_vec3(drawn, place.position);
  add_vec3(drawn, place.normal);
  add_in_sky(drawn, place.in_sky);
  add_word(drawn, place.pdf);
}

SHARED float next_unit(INOUT(Rng) rng) MEMBER_CONST {
  return unit_float(random_word(rng));
}

/// The results of invocation i.
SHARED LightWords light_words_of(uint i) MEMBER_CONST {
  LightWords drawn;
  drawn.count = 0u;
  Rng rng = rng_of(word64_of(0u, 5u), word64_of(0u, 1u), word64_of(0u, i), word64_of(0u, 0u));
  float pick = next_unit(rng);
  float u = next_unit(rng);
  float v = next_unit(rng);
  float side = next_unit(rng);
  LightPlace place = sample_light(pick, u, v, side);
  add_place(drawn, place);
  float a = next_unit(rng);
  float b = next_unit(rng);
  vec3 origin;
  vec3 w;
  leave_light(place, a, b, origin, w);
  add_vec3(drawn, origin);
  add_vec3(drawn, w);
  vec3 emission = vec3(1.0f, 2.0f, 3.0f);
  add_vec3(drawn, source_radiance(place.source, place.normal, emission, place.in_sky, w));
  add_vec3(drawn, source_facing(place.source, place.normal));
  add_word(drawn, emission_pdf_w(place.source, place.normal, w));
  add_word(drawn, cos_per_pdf_w(place.source, w));
  if (scene_has_sky) add_in_sky(drawn, look_at_sky(w));

  Shaded shaded = shaded_places[i % kShadedPlaces];
  Point p = shaded_point(shaded);
  LightContext light_context;
  look_out(p, shaded.facing, light_context);
  add_word(drawn, light_context.seen);
  add_word(drawn, light_context.sent);
  float q = shaded.through_windows;
  LightPlace next = sample_next_event(p, light_context, q, side, u, v, pick);
  add_place(drawn, next);
  add_word(drawn, next_event_pdf(p, light_context, q, next.source, next.triangle, next.position,
                                 next.in_sky));
  add_word(drawn, next_event_pdf(p, light_context, q, place.source, place.triangle, place.position,
                                 place.in_sky));
  while (drawn.count < kLightWords) add_word(drawn, 0.0f);
  return drawn;
}

#include "shaders/shared/language_end.h"
