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
  friend class Part;
  friend class Texels;
  friend class Uniforms;
  std::shared_ptr<Impl> impl_;
};

/// A storage buffer (std430). Its contents are undefined until written.
class Buffer : public Memory {
 public:
  /// Throws when `bytes` is above the limits.
  Buffer(const Device& device, uint64_t bytes);
  /// One that kernels have as Texels, and in Parts: the limit of texels counts, not that of storage
  /// buffers.
  static Buffer of_parts(const Device& device, uint64_t bytes);
  /// One that holds `values`.
  template <class T>
  Buffer(const Device& device, const std::vector<T>& values)
      : Buffer(device, values.size() * sizeof(T)) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(std::as_bytes(std::span(values)));
  }

  /// Its bytes from `at` on.
  void write(std::span<const std::byte> from, uint64_t at = 0);
  void read(std::span<std::byte> to, uint64_t at = 0) const;

  /// Its first `count` values from byte `at` on.
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

/// Part of a buffer, as a storage buffer of its own: a byte or more. `offset`: a multiple of
/// kPartAlignment.
class Part : public Memory {
 public:
  static constexpr uint64_t kPartAlignment = 256;  // no device asks for more
  /// Throws when it is larger than the device allows storage buffers to be.
  Part(const Buffer& buffer, uint64_t offset, uint64_t bytes);
};

/// A buffer for kernels that only read it: `uniform usamplerBuffer`, texels of four words. Some
/// devices read them faster than storage buffers.
class Texels : public Memory {
 public:
  /// Throws when there are more texels than the device allows.
  explicit Texels(const Buffer& buffer);
};

/// A small buffer that all invocations read alike: `layout(std140) uniform`.
class Uniforms : public Memory {
 public:
  /// Throws when it is larger than the device allows.
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
