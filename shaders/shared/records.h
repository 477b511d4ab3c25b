// Records of tables. RECORD(T) is a struct T of whole texels of four words, which TEXELS_OF_T(VEC,
// WORDS, PART) lists; the comment on a member stands above its texel.
//   VEC(a, type, b)                             vec3 a; type b;
//   WORDS(type, a, type, b, type, c, type, d)
//   PART(T, a)                                  another record
// A type is uint, int or float. The layout is that of std430 and of C++. GLSL also gets T
// entry_T(texels, first, i): entry i of a table that begins at texel `first`; likewise for uint,
// float and uvec4. Some devices read texels several times as fast as storage buffers.
#ifndef TDPT_SHADERS_SHARED_RECORDS_H
#define TDPT_SHADERS_SHARED_RECORDS_H

#define MEMBERS_OF_VEC(a, type, b) \
  vec3 a;                          \
  type b;
#define MEMBERS_OF_WORDS(type0, a, type1, b, type2, c, type3, d) \
  type0 a;                                                       \
  type1 b;                                                       \
  type2 c;                                                       \
  type3 d;
#define MEMBERS_OF_PART(T, a) T a;

#ifdef __cplusplus

#include <type_traits>

#define RECORD(T) RECORD_ALIGNED(, T)
// The same with Real instead of float: TOf<double>.
#define RECORD_OF_REALS(T)                                                      \
  template <class Real>                                                         \
  struct T##Of {                                                                \
    template <class Type>                                                       \
    using In = std::conditional_t<std::is_same_v<Type, float>, Real, Type>;     \
    TEXELS_OF_##T(REALS_OF_VEC, REALS_OF_WORDS, ) explicit operator T() const { \
      T r;                                                                      \
      TEXELS_OF_##T(PUT_VEC, PUT_WORDS, ) return r;                             \
    }                                                                           \
  };
#define REALS_OF_VEC(a, type, b) \
  Vec3<Real> a{};                \
  In<type> b{};
#define REALS_OF_WORDS(type0, a, type1, b, type2, c, type3, d) \
  In<type0> a{};                                               \
  In<type1> b{};                                               \
  In<type2> c{};                                               \
  In<type3> d{};
#define PUT_VEC(a, type, b) r.a = vec3(a), r.b = static_cast<type>(b);
#define PUT_WORDS(type0, a, type1, b, type2, c, type3, d)   \
  r.a = static_cast<type0>(a), r.b = static_cast<type1>(b); \
  r.c = static_cast<type2>(c), r.d = static_cast<type3>(d);
#define RECORD_ALIGNED(alignment, T)                                 \
  struct alignment T {                                               \
    TEXELS_OF_##T(MEMBERS_OF_VEC, MEMBERS_OF_WORDS, MEMBERS_OF_PART) \
  };

#else

#define RECORD_ALIGNED(alignment, T) RECORD(T)
#define RECORD(T)                                                                     \
  struct T {                                                                          \
    TEXELS_OF_##T(MEMBERS_OF_VEC, MEMBERS_OF_WORDS, MEMBERS_OF_PART)                  \
  };                                                                                  \
  const uint kTexelsOf_##T = 0u TEXELS_OF_##T(ONE_VEC, ONE_OF_WORDS, TEXELS_OF_PART); \
  T next_##T(usamplerBuffer texels, inout uint at) {                                  \
    T r;                                                                              \
    uvec4 w;                                                                          \
    TEXELS_OF_##T(READ_VEC, READ_WORDS, READ_PART) return r;                          \
  }                                                                                   \
  T entry_##T(usamplerBuffer texels, uint first, uint i) {                            \
    uint at = first + i * kTexelsOf_##T;                                              \
    return next_##T(texels, at);                                                      \
  }
#define ONE_VEC(a, type, b) +1u
#define ONE_OF_WORDS(type0, a, type1, b, type2, c, type3, d) +1u
#define TEXELS_OF_PART(T, a) +kTexelsOf_##T
#define READ_VEC(a, type, b)         \
  w = texelFetch(texels, int(at++)); \
  r.a = uintBitsToFloat(w.xyz);      \
  r.b = type##_of_word(w.w);
#define READ_WORDS(type0, a, type1, b, type2, c, type3, d) \
  w = texelFetch(texels, int(at++));                       \
  r.a = type0##_of_word(w.x);                              \
  r.b = type1##_of_word(w.y);                              \
  r.c = type2##_of_word(w.z);                              \
  r.d = type3##_of_word(w.w);
#define READ_PART(T, a) r.a = next_##T(texels, at);

uint uint_of_word(uint word) {
  return word;
}
int int_of_word(uint word) {
  return int(word);
}
float float_of_word(uint word) {
  return uintBitsToFloat(word);
}
uvec4 entry_uvec4(usamplerBuffer texels, uint first, uint i) {
  return texelFetch(texels, int(first + i));
}
uint entry_uint(usamplerBuffer texels, uint first, uint i) {
  uvec4 w = entry_uvec4(texels, first, i >> 2);
  return w[i & 3u];
}
float entry_float(usamplerBuffer texels, uint first, uint i) {
  return uintBitsToFloat(entry_uint(texels, first, i));
}

#endif

#endif
