// Memory of a device: buffers, and 3D images for atomics.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "libcommon/gpu/device.h"

namespace tdpt::gpu {

/// A buffer or an image. Copies of it are the same memory.
class Memory {
 public:
  struct Impl;
  const Impl& impl() const { return *impl_; }

 protected:
  friend class Texels;
  friend class Uniforms;
  std::shared_ptr<Impl> impl_;
};

/// A storage buffer (std430). Its contents are undefined until written.
class Buffer : public Memory {
 public:
  /// Throws when `bytes` is above the limits.
  Buffer(const Device& device, uint64_t bytes);
  /// One that holds `values`.
  template <class T>
  Buffer(const Device& device, const std::vector<T>& values)
      : Buffer(device, values.size() * sizeof(T)) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(std::as_bytes(std::span(values)));
  }

  /// Its first bytes.
  void write(std::span<const std::byte> from);
  void read(std::span<std::byte> to) const;

  /// Its first `count` values.
  template <class T>
  std::vector<T> download(size_t count) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count);
    read(std::as_writable_bytes(std::span(values)));
    return values;
  }
};

/// A buffer for kernels that only read it: `uniform usamplerBuffer`. Some devices read that faster
/// than the buffer itself.
class Texels : public Memory {
 public:
  enum Size { words = 4, quads = 16 };  ///< bytes of a texel: one word of it (x), or four
  /// Throws when there are more texels than the device allows.
  Texels(const Buffer& buffer, Size size);
};

/// A small buffer that all invocations read alike: `layout(std140) uniform`.
class Uniforms : public Memory {
 public:
  explicit Uniforms(const Buffer& buffer);
};

enum class Texel { r32ui, r32i };

/// A 3D storage image with atomics; all zero at first.
class Image3D : public Memory {
 public:
  /// `size`: texels along x, y, z. Throws when it is above the limits.
  Image3D(const Device& device, const std::array<uint32_t, 3>& size, Texel texel = Texel::r32ui);

  /// Texels with x running fastest, then y; those of r32i as their 32 bits.
  std::vector<uint32_t> download() const;
};

}  // namespace tdpt::gpu
