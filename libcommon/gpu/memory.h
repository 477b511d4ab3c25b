// Device memory: buffers, and 3D images for atomics.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "libcommon/gpu/device.h"

namespace tdpt::gpu {

/// A buffer or an image. Copies share the same memory.
class Memory {
 public:
  struct Impl;
  const Impl& impl() const { return *impl_; }

 protected:
  friend class Part;
  friend class Texels;
  friend class Uniforms;
  std::shared_ptr<Impl> impl_;
};

/// A storage buffer (std430). Undefined until written.
class Buffer : public Memory {
 public:
  /// Throws if `bytes` exceeds the limits.
  Buffer(const Device& device, uint64_t bytes);
  /// A buffer that kernels access as Texels and in Parts: the limit of texels applies, not that of
  /// storage buffers.
  static Buffer of_parts(const Device& device, uint64_t bytes);
  /// Initialised with `values`.
  template <class T>
  Buffer(const Device& device, const std::vector<T>& values)
      : Buffer(device, values.size() * sizeof(T)) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(std::as_bytes(std::span(values)));
  }

  /// Writes bytes from offset `at` on.
  void write(std::span<const std::byte> from, uint64_t at = 0);
  void read(std::span<std::byte> to, uint64_t at = 0) const;

  /// Reads `count` values from byte `at` on.
  template <class T>
  std::vector<T> download(size_t count, uint64_t at = 0) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count);
    read(std::as_writable_bytes(std::span(values)), at);
    return values;
  }

 private:
  Buffer() = default;
  void allocate(const Device& device, uint64_t bytes);
};

/// A part of a buffer as a storage buffer of its own, at least one byte. `offset`: a multiple of
/// kPartAlignment.
class Part : public Memory {
 public:
  static constexpr uint64_t kPartAlignment = 256;  // no device requires more
  /// Throws if it exceeds the device's limit for storage buffers.
  Part(const Buffer& buffer, uint64_t offset, uint64_t bytes);
};

/// A read-only view of a buffer: `uniform usamplerBuffer`, texels of four words. Some devices read
/// it faster than a storage buffer.
class Texels : public Memory {
 public:
  /// Throws if there are more texels than the device allows.
  explicit Texels(const Buffer& buffer);
};

/// A small buffer that all invocations read uniformly: `layout(std140) uniform`.
class Uniforms : public Memory {
 public:
  /// Throws if it exceeds the device's limit.
  explicit Uniforms(const Buffer& buffer);
};

enum class Texel { r32ui, r32i };

/// A 3D storage image with atomics, initially zero.
class Image3D : public Memory {
 public:
  /// `size`: texels along x, y, z. Throws if it exceeds the limits.
  Image3D(const Device& device, const std::array<uint32_t, 3>& size, Texel texel = Texel::r32ui);

  /// Texels, x fastest, then y; r32i as raw 32 bits.
  std::vector<uint32_t> download() const;
};

}  // namespace tdpt::gpu
