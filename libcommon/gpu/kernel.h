// Device memory: buffers, and 3D images for atomics.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <set>
#include <span>
#include <type_traits>

#include "libcommon/gpu/device.h"

namespace tdpt::gpu {

/// A buffer or an image. Copies share the same memory.
class Memory {
 public:
  struct Impl;
  explicit Memory(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 protected:
  Memory() = default;
  std::shared_ptr<Impl> impl_;
};

/// A storage buffer (std430). Undefined until written.
class Buffer : public Memory {
 public:
  /// Throws if `bytes` exceeds the limits.
  Buffer(const Device& device, uint64_t bytes);
  /// A buffer that kernels access as texels() and by part(): the limit of texels applies, not that
  /// of storage buffers.
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

  uint64_t bytes() const;
  /// Reads all values.
  template <class T>
  std::vector<T> download() const {
    return download<T>(bytes() / sizeof(T));
  }
  /// Reads `count` values from byte `at` on.
  template <class T>
  std::vector<T> download(size_t count, uint64_t at = 0) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count);
    read(std::as_writable_bytes(std::span(values)), at);
    return values;
  }

  static constexpr uint64_t kPartAlignment = 256;  // no device requires more
  /// A part of it as a storage buffer of its own, of at least one byte. `offset`: a multiple of
  /// kPartAlignment. Throws if it exceeds the device's limit for storage buffers.
  Memory part(uint64_t offset, uint64_t bytes) const;
  /// A read-only view: `uniform usamplerBuffer`, texels of four words. Some devices read it faster
  /// than a storage buffer. Throws if there are more texels than the device allows.
  Memory texels() const;
  /// A view that all invocations read uniformly, `layout(std140) uniform`; at most 16384 bytes.
  Memory uniforms() const;

 private:
  /// Throws if `bytes` exceeds `most`, of `what`.
  Buffer(const Device& device, uint64_t bytes, uint64_t most, const char* what);
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

// Tables of records concatenated in one buffer, which kernels read as texels
// [shaders/shared/records.h]; a table that kernels write is also bound as a storage buffer.

class Tables {
 public:
  /// Adds a table with `values`, which must stay valid until upload().
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(std::as_bytes(values), values.size_bytes());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }
  /// Adds an uninitialised table of this size.
  void add_room(uint64_t bytes) { add({}, bytes); }

  /// First texel of each table.
  std::vector<uint32_t> first_texels() const;

  /// Allocates and fills the buffer. Throws if it exceeds the limits.
  void upload(const Device& device);
  Memory texels() const { return buffer_->texels(); }
  /// Table i, at least one texel.
  Memory part(size_t i) const { return buffer_->part(tables_[i].begin, tables_[i].bytes); }
  /// Writes to the beginning of table i.
  void write(size_t i, std::span<const std::byte> from) { buffer_->write(from, tables_[i].begin); }

 private:
  struct Table {
    std::span<const std::byte> values;
    uint64_t begin, bytes;
  };
  void add(std::span<const std::byte> values, uint64_t bytes);

  std::vector<Table> tables_;
  uint64_t end_ = 0;
  std::optional<Buffer> buffer_;  // none yet
};

// Compute kernels, and how they are dispatched.

/// A compute shader with the entry point main, and the memory bound to it. Copies share one kernel.
class Kernel {
 public:
  /// `program`: SPIR-V, as tdpt_shaders() of cmake/tdpt.cmake writes it to shaders/NAME.h.
  /// `memory`: bound to layout(set = 0, binding = 0, 1, 2, ...); kept alive by the kernel. Bindings
  /// that the program does not use are not bound and count for no limit. `push_bytes`: size of the
  /// push constants, a multiple of 4. `constants`: specialisation constants with constant_id 0, 1,
  /// 2, ...; bools are 0 or 1.
  Kernel(const Device& device, std::span<const uint32_t> program, const std::vector<Memory>& memory,
         uint32_t push_bytes = 0, const std::vector<uint32_t>& constants = {});

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<Impl> impl_;
};

/// How many storage buffers a program uses of the memory that several programs share.
size_t storage_buffers_in(std::span<const uint32_t> program);

/// The constant_ids that a program reads: other constants do not change its kernel.
std::set<uint32_t> constants_of(std::span<const uint32_t> program);

/// Push constants: one struct, laid out as in the shader.
template <class T>
std::span<const std::byte> push(const T& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span(&values, 1));
}

/// Passed by Device::run. All arguments must live until run() returns.
class Commands {
 public:
  /// `push`: from push(), or {}. `groups`: work groups along x; throws above the device's limit.
  void dispatch(const Kernel& kernel, std::span<const std::byte> push, uint32_t groups);
  /// The device reads the work groups along x, y, z from three uint32 in `groups` at byte `offset`
  /// (a multiple of 4). Their writer must keep each below 65536, which every device allows.
  void dispatch_indirect(const Kernel& kernel, std::span<const std::byte> push,
                         const Buffer& groups, uint64_t offset = 0);
  /// Sets every texel to 0.
  void clear(const Image3D& image);
  /// Sets every byte to 0.
  void clear(const Buffer& buffer);

  struct Impl;
  explicit Commands(const Impl& impl) : impl_(impl) {}
  const Impl& impl() const { return impl_; }

 private:
  const Impl& impl_;
};

}  // namespace tdpt::gpu
