// Macros that let one text be both C++ and GLSL. Every header of this folder is read by both
// compilers, so that a kernel and its scalar build on the CPU run the same operations in the same
// order and give the same bits. Such a header includes this file after all others and
// language_end.h at its end, so that no macro leaks to its includer. A text for the body of a C++
// struct has no include guard; C++ has already read the headers it includes before the struct.
//
// Vulkan rounds sums and products of floats correctly (to the nearest on every device we know) as
// long as they are not contracted into fused operations: cmake/compile-shader.sh prevents that. It
// does not round quotients, roots and sines correctly: use those of real.h. It leaves the order of
// operations in its own dot(), cross(), normalize() and mix() open: use those of vector.h. Never
// draw two random numbers in one expression: C++ leaves their order open. Write a constant as one
// number: GLSL's compiler evaluates 23.0f * 1.07f with more digits than a float has.
//
// Code that the CPU runs in doubles and a device in floats is one text over REAL and VEC3. Free
// functions are GENERIC; a text for a struct's body uses the struct's own `Real`. A literal has an
// f if a float holds it exactly or if a small error does no harm; any other is written REAL(0.04).
// Stored records hold floats: VEC3(record.color).
#include "shaders/shared/types.h"

#ifdef __cplusplus

#define SHARED_BEGIN namespace tdpt::shader {
#define SHARED_END }
#define SHARED inline       // before every function
#define MEMBER_CONST const  // after every function that is a member in C++ (see traversal.h)
#define MEMBER              // the same for members that write
#define CACHE_LINE alignas(64)
#define OUT(type) type&       // a parameter that is written
#define INOUT(type) type&     // a parameter that is read and written
#define IN(type) const type&  // a large parameter that is read only
#define GENERIC_STRUCT  \
  template <class Real> \
  struct
#define GENERIC         \
  template <class Real> \
  constexpr  // before every function, instead of SHARED
#define REAL Real
#define VEC3 Vec3<Real>
#define ROUNDING REAL(sizeof(REAL) == sizeof(float) ? 2.4e-7f : 4.5e-16)  // relative
#define OF_REAL(type) type<Real>                                          // a GENERIC_STRUCT
#define OF_FLOAT(type) type<float>  // the same, where everything is in floats

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
