// Types and functions that one of the two languages lacks: for C++, GLSL's vectors and the
// functions on them that this folder calls; for GLSL, 64-bit words. This folder depends on nothing
// else of the project.
#ifndef TDPT_SHADERS_SHARED_TYPES_H
#define TDPT_SHADERS_SHARED_TYPES_H

#ifdef __cplusplus

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace tdpt {

/// Three components: for points, directions and RGB.
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  constexpr explicit Vec3(T s) : x(s), y(s), z(s) {}
  template <class U>
  constexpr explicit Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

  constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }

  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
  constexpr Vec3& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
  friend constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vec3 operator*(const Vec3& a, const Vec3& b) {  // componentwise, for colours
    return {a.x * b.x, a.y * b.y, a.z * b.z};
  }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return a *= s; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return a *= s; }
  friend constexpr Vec3 operator/(const Vec3& a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

}  // namespace tdpt

namespace tdpt::shader {

using uint = uint32_t;
using vec3 = Vec3<float>;
using ivec3 = Vec3<int32_t>;
struct uvec4 {
  uint word[4]{};

  constexpr uvec4() = default;
  constexpr uvec4(uint x, uint y, uint z, uint w) : word{x, y, z, w} {}
  constexpr uint operator[](uint i) const { return word[i]; }
  constexpr uint& operator[](uint i) { return word[i]; }
  friend constexpr uvec4 operator^(const uvec4& a, const uvec4& b) {
    return {a[0] ^ b[0], a[1] ^ b[1], a[2] ^ b[2], a[3] ^ b[3]};
  }
};

using std::abs;
using std::floor;
using std::max;
using std::min;
// For code in doubles, against a float literal.
constexpr double max(double a, float b) {
  return max(a, double{b});
}
constexpr double min(double a, float b) {
  return min(a, double{b});
}

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
/// Returns the old value.
inline uint atomicAdd(uint& word, uint more) {
  return std::atomic_ref(word).fetch_add(more, std::memory_order_relaxed);
}
inline uint atomicMax(uint& word, uint at_least) {
  const std::atomic_ref shared(word);
  uint before = shared.load(std::memory_order_relaxed);
  while (before < at_least &&
         !shared.compare_exchange_weak(before, at_least, std::memory_order_relaxed)) {
  }
  return before;
}
/// Index of the lowest set bit; x not 0.
constexpr int findLSB(uint x) {
  return std::countr_zero(x);
}
/// Reverses the order of the bits.
constexpr uint bitfieldReverse(uint x) {
  x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  return __builtin_bswap32(x);
}

using word64 = uint64_t;
constexpr word64 word64_of(uint high, uint low) {
  return word64{high} << 32 | low;
}
constexpr uint high_word(word64 a) {
  return static_cast<uint>(a >> 32);
}
constexpr uint low_word(word64 a) {
  return static_cast<uint>(a);
}
constexpr word64 sum64(word64 a, word64 b) {
  return a + b;
}
constexpr word64 product64(word64 a, word64 b) {
  return a * b;
}
/// `a` shifted down by 1 to 31 bits.
constexpr word64 down64(word64 a, uint bits) {
  return a >> bits;
}

}  // namespace tdpt::shader

#else

#define word64 uvec2  // low word, high word

word64 word64_of(uint high, uint low) {
  return uvec2(low, high);
}
uint high_word(word64 a) {
  return a.y;
}
uint low_word(word64 a) {
  return a.x;
}
word64 sum64(word64 a, word64 b) {
  uint carry;
  uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}
word64 product64(word64 a, word64 b) {
  uint high;
  uint low;
  umulExtended(a.x, b.x, high, low);
  return uvec2(low, high + a.x * b.y + a.y * b.x);
}
word64 down64(word64 a, uint bits) {
  return uvec2(a.x >> bits | a.y << (32u - bits), a.y >> bits);
}

#endif

#endif
