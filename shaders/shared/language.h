// What lets one text be C++ and GLSL: types, qualifiers and the few functions that one of the two
// lacks. Every header of this folder is read by both compilers, so that a kernel and its twin on
// the CPU run the same operations in the same order and give the same bits.
//
// Vulkan rounds sums and products of floats correctly, and every device we know to the nearest, as
// long as none is contracted into a fused one: keep every float in an EXACT variable. It does not
// round quotients, roots and sines correctly: use those of real.h. dot(), cross(), normalize() and
// mix() leave the order open: use those of real.h. Never draw two random numbers in one expression:
// C++ leaves their order open.
#ifndef TDPT_SHADERS_SHARED_LANGUAGE_H
#define TDPT_SHADERS_SHARED_LANGUAGE_H

#ifdef __cplusplus

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "libcommon/math/vec.h"

#define SHARED_BEGIN namespace tdpt::shader {
#define SHARED_END }
#define SHARED inline      // before every function
#define EXACT              // before every float that is computed
#define OUT(type) type&    // a parameter that is written
#define INOUT(type) type&  // a parameter that is read and written

namespace tdpt::shader {

using uint = uint32_t;
using vec3 = Vec3f;
using ivec3 = Vec3<int32_t>;
struct uvec2 {
  uint x, y;
};
struct uvec4 {
  uint x, y, z, w;
};

using std::abs;
using std::floor;
using std::max;
using std::min;

inline uint floatBitsToUint(float x) {
  return std::bit_cast<uint>(x);
}
inline float uintBitsToFloat(uint x) {
  return std::bit_cast<float>(x);
}
/// high and low half of the product of `a` and `b`
inline void umulExtended(uint a, uint b, uint& high, uint& low) {
  const uint64_t product = uint64_t{a} * b;
  high = static_cast<uint>(product >> 32);
  low = static_cast<uint>(product);
}

}  // namespace tdpt::shader

#else

#define SHARED_BEGIN
#define SHARED_END
#define SHARED
#define EXACT precise
#define OUT(type) out type
#define INOUT(type) inout type

#endif

#endif
