// Test only: results of all functions on surfaces at random points, as words, to compare a device
// with C++. Include after surface.h, in its scope, and after words_test.h.

#include "shaders/shared/language.h"

SHARED void put(INOUT(PlaceWords) out_words, float x) MEMBER_CONST {
  out_words.words[out_words.count] = floatBitsToUint(x);
  out_words.count += 1u;
}
SHARED void put(INOUT(PlaceWords) out_words, vec3 v) MEMBER_CONST {
  put(out_words, v.x);
  put(out_words, v.y);
  put(out_words, v.z);
}
SHARED void put(INOUT(PlaceWords) out_words, bool b) MEMBER_CONST {
  put(out_words, b ? 1.0f : 0.0f);
}

SHARED float next_unit(INOUT(Rng) rng) MEMBER_CONST {
  return unit_float(random_word(rng));
}
SHARED vec3 next_direction(INOUT(Rng) rng) MEMBER_CONST {
  float u = next_unit(rng);
  float v = next_unit(rng);
  vec3 w = cosine_hemisphere(u, v);
  return next_unit(rng) < 0.5f ? w : -w;
}

/// The tests of point i, and their results. `triangles`: of the scene.
SHARED PlaceWords words_of_place(uint i, uint triangles) MEMBER_CONST {
  PlaceWords words;
  words.count = 0u;
  Rng rng = rng_of(word64_of(0u, 21u), word64_of(0u, 5u), word64_of(0u, i), word64_of(0u, 0u));
  uint triangle = below(random_word(rng), triangles);
  float u = next_unit(rng);
  float v = next_unit(rng);
  float b1;
  float b2;
  uniform_triangle(u, v, b1, b2);
  Point p;
  place_on_surface(triangle, b1, b2, p);
  put(words, p.position);
  put(words, p.shading);
  put(words, p.color);
  put(words, p.emission);
  put(words, p.connectible);
  put(words, p.simple);
  vec3 back = to_world(onb_about(p.normal), next_direction(rng));
  vec3 to = to_world(onb_about(p.normal), next_direction(rng));
  u = next_unit(rng);
  v = next_unit(rng);
  float choice = next_unit(rng);
  OF_FLOAT(Turn) t;
  bool turns = turn(p, i & 1u, back, u, v, choice, t);
  put(words, turns);
  put(words, t.dirac);
  if (turns) {
    put(words, t.w);
    put(words, t.weight);
  }
  // In a loop (forth and back along the turn, and to a random direction), so that each function is
  // called once: kernels inline every call.
  vec3 here = back;
  vec3 there = turns ? t.w : to;
  for (uint k = 0u; k < 3u; ++k) {
    put(words, bsdf_at(p, here, there));
    put(words, scatter_pdf_w(p, here, there, turns && t.dirac && k < 2u));
    vec3 next = k == 0u ? here : to;
    here = k == 0u ? there : back;
    there = next;
  }
  if (turn_towards(p, i & 1u, back, to, t)) put(words, t.weight);
  put(words, albedo_at(p, back));
  OF_FLOAT(Odds) odds = odds_at(p, back);
  put(words, odds.dirac);
  put(words, odds.broad);
  put(words, emission_under_coat(p, back));
  put(words, opacity_at(triangle, back));
  put(words, coverage_at(triangle, b1, b2));
  put(words, surface_stops(triangle, b1, b2, i, back));
  put(words, transmittance(p, p, back, 0.5f));
  while (words.count < kWordsOfPlace) put(words, 0.0f);
  return words;
}

#include "shaders/shared/language_end.h"
