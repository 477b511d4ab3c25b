// What lets one text be C++ and GLSL. Every header of this folder is read by both compilers, so
// that a kernel and its scalar build on the CPU run the same operations in the same order and give
// the same bits. It begins with this file, behind the other headers it needs, and ends with
// language_end.h, so that no macro is left to who includes it. A text that stands in a struct's
// body in C++ has no include guard; the headers that it includes C++ has read before the struct.
//
// Vulkan rounds sums and products of floats correctly, and every device we know to the nearest, as
// long as none is contracted into a fused one: cmake/compile-shader.sh sees to that. It does not
// round quotients, roots and sines correctly: use those of real.h. It leaves the order of its own
// dot(), cross(), normalize() and mix() open: use those of vector.h. Never draw two random numbers
// in one expression: C++ leaves their order open. Write a constant as one number: GLSL's compiler
// works out 23.0f * 1.07f in more digits than a float has.
//
// What the CPU counts in doubles and a device in floats is one text over REAL and VEC3: free
// functions are GENERIC, and a text that stands in a struct's body in C++ takes the struct's own
// `Real`. Its literals have their f where a float holds them exactly or a little more or less
// changes nothing; any other is REAL(0.04). Records that are stored hold floats:
// VEC3(record.color).
#include "shaders/shared/types.h"

#ifdef __cplusplus

#define SHARED_BEGIN namespace tdpt::shader {
#define SHARED_END }
#define SHARED inline       // before every function
#define MEMBER_CONST const  // after every function that C++ has as a member, see traversal.h,
#define MEMBER              // but for those that write
#define CACHE_LINE alignas(64)
#define OUT(type) type&       // a parameter that is written
#define INOUT(type) type&     // a parameter that is read and written
#define IN(type) const type&  // a large one that is read
#define GENERIC_STRUCT  \
  template <class Real> \
  struct
#define GENERIC         \
  template <class Real> \
  constexpr  // before every function, instead of SHARED
#define REAL Real
#define VEC3 Vec3<Real>
#define ROUNDING REAL(sizeof(REAL) == sizeof(float) ? 2.4e-7f : 4.5e-16)  // of a product or two
#define OF_REAL(type) type<Real>                                          // a GENERIC_STRUCT
#define OF_FLOAT(type) type<float>  // the same where all counts in floats

#else

#define SHARED_BEGIN
#define SHARED_END
#define SHARED
#define MEMBER_CONST
#define MEMBER
#define CACHE_LINE
#define OUT(type) out type
#define INOUT(type) inout type
#define IN(type) type
#define GENERIC_STRUCT struct
#define GENERIC
#define REAL float
#define VEC3 vec3
#define ROUNDING 2.4e-7f
#define OF_REAL(type) type
#define OF_FLOAT(type) type
#define dot exact_dot
#define cross exact_cross

#endif

#define INVERSE_PI REAL(0.318309886183790672)
