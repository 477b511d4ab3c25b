// Memory of a device: buffers, and 3D images for atomics.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "libcommon/gpu/device.h"

namespace tdpt::gpu {

/// A storage buffer (std430). Its contents are undefined until written.
class Buffer {
 public:
  /// `bytes` is rounded up to a multiple of 4, at least 4. Throws when it is above the limits.
  Buffer(const Device& device, uint64_t bytes);
  /// One that holds `values`.
  template <class T>
  Buffer(const Device& device, const std::vector<T>& values)
      : Buffer(device, values.size() * sizeof(T)) {
    upload(values);
  }
  Buffer(Buffer&&) = default;
  Buffer& operator=(Buffer&&) = default;

  uint64_t bytes() const;

  void write(uint64_t offset, std::span<const std::byte> from);
  void read(uint64_t offset, std::span<std::byte> to) const;

  /// Values from byte `offset` on.
  template <class T>
  void upload(const std::vector<T>& values, uint64_t offset = 0) {
    static_assert(std::is_trivially_copyable_v<T>);
    write(offset, std::as_bytes(std::span(values)));
  }
  /// `count` values from byte `offset` on.
  template <class T>
  std::vector<T> download(size_t count, uint64_t offset = 0) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count);
    read(offset, std::as_writable_bytes(std::span(values)));
    return values;
  }

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

enum class Texel { r32ui, r32i };

/// A 3D storage image with atomics; all zero at first.
class Image3D {
 public:
  /// `size`: texels along x, y, z. Throws when it is above the limits.
  Image3D(const Device& device, const std::array<uint32_t, 3>& size, Texel texel = Texel::r32ui);
  Image3D(Image3D&&) = default;
  Image3D& operator=(Image3D&&) = default;

  const std::array<uint32_t, 3>& size() const;

  /// Texels with x running fastest, then y; those of r32i as their 32 bits.
  std::vector<uint32_t> download() const;

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

}  // namespace tdpt::gpu
